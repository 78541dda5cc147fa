# Writes migrations_embedded.cc from migrations/NNNN_name.sql. The list is explicit, like all sources.
set(MIGRATION_ROWS "")
foreach(file IN LISTS MIGRATION_FILES)
  get_filename_component(name ${file} NAME_WE)
  string(REGEX MATCH "^([0-9]+)_" ignored ${name})
  math(EXPR number "1${CMAKE_MATCH_1} - 10000")
  file(READ ${CMAKE_CURRENT_SOURCE_DIR}/${file} sql)
  string(APPEND MIGRATION_ROWS "    Migration{${number}, \"${name}\", R\"sql(\n${sql})sql\"},\n")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file})
endforeach()
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/migrations_embedded.cc @ONLY CONTENT [[
#include "server/store/migrations.h"

namespace moduli {
namespace {

constexpr Migration kMigrations[] = {
@MIGRATION_ROWS@};

}  // namespace

std::span<const Migration> allMigrations() {
  return kMigrations;
}

}  // namespace moduli
]])
