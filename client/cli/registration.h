#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/mesh_argument.h"
#include "client/cli/session.h"
#include "client/cpp/client.h"
#include "core/base/status.h"
#include "moduli/v1/parameterization.pb.h"

/// The part of `parameterize` that lays a sphere onto another.
namespace moduli::cli {

/// --reference and what goes with it.
std::vector<OptionSpec> registrationOptions();

/// What of it is wrong together, as a complaint; nothing if all is well.
std::optional<std::string> checkRegistrationArguments(const Arguments& arguments);

/// The files of a registration, opened before there is a client.
class RegistrationFiles {
 public:
  /// Without --reference there is nothing. Fails as MeshArgument::open, MeshBytes::ofFile and
  /// readLandmarks do.
  static Result<RegistrationFiles> open(const Session& session, const Arguments& arguments);

  bool wanted() const { return reference_.has_value(); }
  /// What the store has to be for the reference.
  StoreNeed need() const { return wanted() ? reference_->need() : StoreNeed::kNone; }

  /// How large a file may be within the request: several share its room.
  std::uint64_t inlineLimit() const;

  /// The message, with the files sent. Fails as Client::sendMesh does.
  Result<v1::SphereRegistration> message(Client& client) const;

  /// The file that a failure speaks of, if its message begins with one's name; otherwise
  /// `otherwise`.
  std::string subjectOf(const Status& status, const std::string& otherwise) const;

 private:
  struct Values {
    std::string name;
    MeshBytes bytes;
  };
  static Result<std::optional<Values>> openValues(const Arguments& arguments,
                                                  const std::string& key);

  v1::SphereRegistration landmarks_;  ///< And whether to mirror.
  std::string landmark_file_;
  std::optional<MeshArgument> reference_;
  std::optional<Values> field_, reference_field_;
};

}  // namespace moduli::cli
