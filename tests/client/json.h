#pragma once

#include <google/protobuf/struct.pb.h>

#include <string>
#include <vector>

/// A JSON document for tests to look into.
///
///   const Json json = Json::parse(result.out);
///   EXPECT_EQ(json["topology"]["genus"].number(), 1);
///
/// What is not there reads as a null; a test that meets one where it wants more fails.
namespace moduli {

class Json {
 public:
  /// Fails the running test unless `text` is one document and a newline.
  static Json parse(const std::string& text);

  Json operator[](const std::string& key) const;
  Json at(int index) const;
  bool has(const std::string& key) const;
  /// Elements of a list; 0 for anything else.
  int size() const;
  std::vector<std::string> keys() const;

  /// These fail the running test on a value of another kind.
  double number() const;
  std::string string() const;
  bool boolean() const;
  bool isList() const;
  bool isNumber() const;

 private:
  explicit Json(google::protobuf::Value value) : value_(std::move(value)) {}

  google::protobuf::Value value_;
};

}  // namespace moduli
