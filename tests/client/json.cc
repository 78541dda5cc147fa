#include "tests/client/json.h"

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <limits>

namespace moduli {

using google::protobuf::Value;

Json Json::parse(const std::string& text) {
  Value value;
  EXPECT_TRUE(text.ends_with("}\n")) << text;
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(text, &value).ok()) << text;
  return Json(std::move(value));
}

Json Json::operator[](const std::string& key) const {
  const auto& fields = value_.struct_value().fields();
  const auto found = fields.find(key);
  return Json(found == fields.end() ? Value() : found->second);
}

Json Json::at(int index) const {
  const bool there = index < value_.list_value().values_size();
  return Json(there ? value_.list_value().values(index) : Value());
}

bool Json::has(const std::string& key) const {
  return value_.struct_value().fields().contains(key);
}

int Json::size() const {
  return value_.list_value().values_size();
}

std::vector<std::string> Json::keys() const {
  std::vector<std::string> names;
  for (const auto& [name, value] : value_.struct_value().fields()) names.push_back(name);
  return names;
}

double Json::number() const {
  EXPECT_TRUE(isNumber()) << value_.ShortDebugString();
  return isNumber() ? value_.number_value() : std::numeric_limits<double>::quiet_NaN();
}

std::string Json::string() const {
  EXPECT_EQ(value_.kind_case(), Value::kStringValue) << value_.ShortDebugString();
  return value_.string_value();
}

bool Json::boolean() const {
  EXPECT_EQ(value_.kind_case(), Value::kBoolValue) << value_.ShortDebugString();
  return value_.bool_value();
}

bool Json::isList() const {
  return value_.kind_case() == Value::kListValue;
}

bool Json::isNumber() const {
  return value_.kind_case() == Value::kNumberValue;
}

}  // namespace moduli
