#include <algorithm>

#include "client/cpp/client_impl.h"

namespace moduli {
namespace {

constexpr std::uint64_t kChunk = 1ULL << 20;

bool mayResume(const grpc::Status& failure) {
  // ABORTED: the server has another number of bytes than we thought; asking again tells.
  return failure.error_code() == grpc::StatusCode::ABORTED;
}

}  // namespace

grpc::Status Client::Impl::sendChunks(const MeshBytes& bytes, const std::string& digest,
                                      std::uint64_t offset, Status& reading) {
  CallRunner::Attempt attempt(runner);
  v1::UploadMeshResponse response;
  const auto writer = geometry->UploadMesh(&attempt.context(), &response);
  v1::UploadMeshRequest request;
  request.set_digest(digest);
  bool last = false;
  while (!last) {
    const std::uint64_t length = std::min(kChunk, bytes.size() - offset);
    Result<std::string> piece = bytes.read(offset, static_cast<std::size_t>(length));
    if (!piece.ok()) {
      reading = piece.status();
      attempt.context().TryCancel();
      break;
    }
    last = offset + length == bytes.size();
    request.set_write_offset(static_cast<std::int64_t>(offset));
    request.set_data(*std::move(piece));
    request.set_finish_write(last);
    if (last) request.set_total_size(static_cast<std::int64_t>(bytes.size()));
    // A refused write: the server has answered already; Finish tells what.
    if (!writer->Write(request)) break;
    offset += length;
    v1::Progress progress;
    progress.set_stage("upload");
    progress.set_fraction(static_cast<double>(offset) / static_cast<double>(bytes.size()));
    runner.report(progress);
  }
  writer->WritesDone();
  return writer->Finish();
}

Status Client::Impl::upload(const MeshBytes& bytes, const std::string& digest) {
  Backoff backoff = runner.makeBackoff();
  std::int64_t furthest = -1;
  while (true) {
    v1::QueryUploadRequest query;
    query.set_digest(digest);
    Result<v1::QueryUploadResponse> state = unary<v1::QueryUploadResponse>(
        true, *geometry, &v1::GeometryService::Stub::QueryUpload, query);
    if (!state.ok() && state.status().reason() != Reason::kUploadNotFound) return state.status();
    const std::int64_t committed = state.ok() ? state->committed_size() : 0;
    if (state.ok() && state->complete()) return {};
    if (committed > furthest && furthest >= 0) backoff.reset();
    furthest = std::max(furthest, committed);

    const std::uint64_t offset =
        std::min(static_cast<std::uint64_t>(std::max<std::int64_t>(committed, 0)), bytes.size());
    Status reading;
    const grpc::Status sent = sendChunks(bytes, digest, offset, reading);
    RETURN_IF_ERROR(reading);
    if (sent.ok()) return {};
    const bool again = mayResume(sent) ? backoff.another() : runner.waitToRetry(sent, backoff);
    if (!again) return finished(sent);
  }
}

Result<v1::MeshSource> Client::Impl::source(const MeshBytes& bytes, const std::string& digest,
                                            const std::string& name, v1::MeshSource::Format format,
                                            std::uint64_t inline_limit) {
  v1::MeshSource source;
  source.set_format(format);
  source.set_file_name(printable(name, 1024));
  if (bytes.size() <= std::min(inline_limit, kInlineLimit)) {
    ASSIGN_OR_RETURN(*source.mutable_inline_(),
                     bytes.read(0, static_cast<std::size_t>(bytes.size())));
    return source;
  }
  std::string key = digest;
  if (key.empty()) {
    ASSIGN_OR_RETURN(key, bytes.digest());
  }
  RETURN_IF_ERROR(upload(bytes, key));
  source.set_digest(key);
  return source;
}

Result<v1::MeshSource> Client::sendMesh(const MeshBytes& bytes, const std::string& name,
                                        v1::MeshSource::Format format, std::uint64_t inline_limit) {
  return impl_->source(bytes, "", name, format, inline_limit);
}

}  // namespace moduli
