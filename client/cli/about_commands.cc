#include <google/protobuf/stubs/common.h>
#include <CLI/Version.hpp>

#include <vector>

#include "client/cli/command.h"
#include "client/cli/pages.h"
#include "client/cli/session.h"

/// serve, version, completion, man.
namespace moduli::cli {
namespace {

struct Library {
  std::string name, version;
};

std::vector<Library> libraries() {
  return {{"grpc", MODULI_GRPC_VERSION},
          {"protobuf", google::protobuf::internal::VersionString(GOOGLE_PROTOBUF_VERSION)},
          {"cli11", CLI11_VERSION}};
}

// What this build's own services say, hosted in this process.
Result<v1::ServerInfo> ownInfo(Session& session) {
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kNone));
  return client->serverInfo();
}

std::string versionJson(const v1::ServerInfo& info, const std::string& server) {
  JsonWriter json;
  json.open("{").key("version").string(MODULI_VERSION);
  json.key("descriptor_version").number(info.descriptor_version());
  json.key("build").open("{").key("type").string(MODULI_BUILD_TYPE);
  json.key("compiler").string(MODULI_COMPILER).close("}");
  json.key("libraries").open("{");
  for (const Library& library : libraries()) json.key(library.name).string(library.version);
  json.close("}");
  if (!server.empty()) {
    json.key("server").open("{").key("address").string(server);
    json.key("version").string(info.version()).close("}");
  }
  json.close("}");
  return json.finish();
}

std::string versionText(const v1::ServerInfo& info, const std::string& server) {
  std::string text = "moduli " MODULI_VERSION " (" MODULI_BUILD_TYPE ", " MODULI_COMPILER ")\n";
  text += "descriptor version " + std::to_string(info.descriptor_version()) + "\n";
  for (const Library& library : libraries()) text += library.name + " " + library.version + "\n";
  if (!server.empty()) text += "server " + server + ": modulid " + safe(info.version()) + "\n";
  return text;
}

Status runVersion(Session& session, const Arguments&) {
  const Result<v1::ServerInfo> info = ownInfo(session);
  if (!info.ok()) return session.explain("version", info.status());
  if (session.json()) return session.print(versionJson(*info, session.server()));
  return session.print(versionText(*info, session.server()));
}

Status runCompletion(Session& session, const Arguments&) {
  return session.print(bashCompletion());
}

std::string joinedPath(const Arguments& arguments) {
  std::string path;
  for (const std::string& word : arguments.all("COMMAND")) path += (path.empty() ? "" : " ") + word;
  return path;
}

std::optional<std::string> checkManual(const Arguments& arguments) {
  const std::string path = joinedPath(arguments);
  if (!manualPage(path).empty()) return std::nullopt;
  return "there is no command '" + path + "'";
}

Status runManual(Session& session, const Arguments& arguments) {
  return session.print(manualPage(joinedPath(arguments)));
}

}  // namespace

std::vector<CommandSpec> aboutCommands() {
  return {
      {.path = "serve",
       .summary = "Run the server, modulid, with the options that follow",
       .details = "The same as running modulid, which stands beside this program; 'moduli serve "
                  "--help' tells its options.",
       .arguments = {},
       .options = {},
       .examples = "moduli serve --listen 127.0.0.1:7447 --data /srv/moduli",
       .passes_on = true},
      {.path = "version",
       .summary = "Tell the version of the program and of what it is built from",
       .details = "With --server also that of the server.",
       .arguments = {},
       .options = {},
       .run = runVersion},
      {.path = "completion",
       .summary = "Print a completion script for a shell",
       .details = "Load it with: source <(moduli completion bash)",
       .arguments = {{.name = "SHELL",
                      .help = "bash",
                      .completion = Completion::kNothing,
                      .choices = {"bash"}}},
       .options = {},
       .run = runCompletion},
      {.path = "man",
       .summary = "Print a manual page",
       .details = "As roff; show it with: moduli man inspect | man -l -",
       .arguments = {{.name = "COMMAND",
                      .help = "The command; without one, the page of the program",
                      .min = 0,
                      .max = 2,
                      .completion = Completion::kNothing}},
       .options = {},
       .check = checkManual,
       .run = runManual}};
}

}  // namespace moduli::cli
