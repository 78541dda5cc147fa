#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/status.h"

/// A gRPC server that does as a script says, for what a true server does only when it has bad luck.
namespace moduli {

struct FakeScript {
  bool knows_nothing = false;            ///< Has none of our services.
  std::vector<Status> refusals = {};     ///< Answers of ComputeSignature before the first success.
  bool hang = false;                     ///< ComputeSignature waits until it is cancelled.
  std::uint64_t break_upload_after = 0;  ///< Bytes after which the first upload breaks; 0: never.
  int break_ingest_after = 0;            ///< Items after which the first ingest breaks; 0: never.
};

/// What has arrived.
struct FakeRecord {
  int signature_calls = 0;
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
