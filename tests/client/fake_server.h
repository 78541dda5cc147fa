#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "moduli/v1/geometry_service.pb.h"

/// A gRPC server that does as a script says, for what a true server does only when it has bad luck.
namespace moduli {

struct FakeScript {
  bool knows_nothing = false;            ///< Has none of our services.
  std::vector<Status> refusals = {};     ///< Answers of ComputeSignature before the first success.
  bool hang = false;                     ///< Computing calls wait until they are cancelled.
  std::uint64_t break_upload_after = 0;  ///< Bytes after which the first upload breaks; 0: never.
  int break_ingest_after = 0;            ///< Items after which the first ingest breaks; 0: never.
  std::vector<v1::ParameterizeResponse> parameterization = {};  ///< What Parameterize sends.
  std::size_t break_parameterize_after = 0;  ///< Messages after which its first call breaks.
};

/// What has arrived.
struct FakeRecord {
  int signature_calls = 0;
  int parameterize_calls = 0;
  std::string token;
  std::string uploaded;
  std::uint64_t upload_bytes_sent = 0;
  std::vector<std::int64_t> upload_starts;  ///< write_offset of each stream's first message.
  int ingest_streams = 0;
  std::map<std::string, int> stored;  ///< How many times each shape was stored.
};

class FakeServer {
 public:
  explicit FakeServer(const FakeScript& script);
  ~FakeServer();

  std::string address() const;
  FakeRecord record() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace moduli
