#include "server/store/filter.h"

#include <array>
#include <cmath>
#include <compare>
#include <optional>

#include "core/base/text.h"

namespace moduli {
namespace {

constexpr std::size_t kMaxLength = 4096;
constexpr std::size_t kMaxComparisons = 64;

bool isWordCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.';
}

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool isTypeName(std::string_view text) {
  constexpr int last = static_cast<int>(ConformalType::kBordered);
  for (int i = 0; i <= last; ++i) {
    if (conformalTypeName(static_cast<ConformalType>(i)) == text) return true;
  }
  return false;
}

}  // namespace

/// Reads a filter from left to right, one token at a time.
class FilterParser {
 public:
  explicit FilterParser(std::string_view text) : text_(text) {}

  Result<Filter> parse() {
    if (text_.size() > kMaxLength) {
      return Status(Reason::kInvalidFilter, "the filter is longer than 4096 bytes");
    }
    Filter filter;
    skipBlanks();
    while (at_ < text_.size() || !filter.comparisons_.empty()) {
      if (filter.comparisons_.size() == kMaxComparisons) {
        return failure(at_, "more than 64 comparisons");
      }
      ASSIGN_OR_RETURN(Filter::Comparison comparison, readComparison());
      filter.comparisons_.push_back(std::move(comparison));
      skipBlanks();
      if (at_ == text_.size()) break;
      const std::size_t start = at_;
      if (readWord() != "AND") return failure(start, "expected AND or the end");
      skipBlanks();
    }
    return filter;
  }

 private:
  using Comparison = Filter::Comparison;
  using Field = Filter::Field;
  using Operator = Filter::Operator;

  Result<Comparison> readComparison() {
    Comparison comparison;
    RETURN_IF_ERROR(readField(comparison));
    skipBlanks();
    const std::size_t operator_start = at_;
    RETURN_IF_ERROR(readOperator(comparison));
    skipBlanks();
    const std::size_t value_start = at_;
    RETURN_IF_ERROR(readValue(comparison));
    RETURN_IF_ERROR(judge(comparison, operator_start, value_start));
    return comparison;
  }

  Status readField(Comparison& comparison) {
    constexpr std::array<std::pair<std::string_view, Field>, 8> kFields{
        {{"name", Field::kName},
         {"label", Field::kLabel},
         {"type", Field::kType},
         {"genus", Field::kGenus},
         {"boundary_loops", Field::kBoundaryLoops},
         {"vertices", Field::kVertices},
         {"faces", Field::kFaces},
         {"area", Field::kArea}}};
    const std::size_t start = at_;
    const std::string_view word = readWord();
    if (word.starts_with("tags.")) return readTagKey(comparison, start, word.substr(5));
    for (const auto& [name, field] : kFields) {
      if (word != name) continue;
      comparison.field = field;
      return {};
    }
    return failure(start,
                   "expected one of name label type genus boundary_loops vertices faces area "
                   "tags.KEY");
  }

  Status readTagKey(Comparison& comparison, std::size_t start, std::string_view key) {
    comparison.field = Field::kTag;
    comparison.tag = key;
    if (key.empty() && at_ < text_.size() && text_[at_] == '"') {
      ASSIGN_OR_RETURN(comparison.tag, readString());
    }
    if (comparison.tag.empty()) return failure(start + 5, "expected a tag's key");
    return {};
  }

  Status readOperator(Comparison& comparison) {
    constexpr std::array<std::pair<std::string_view, Operator>, 6> kOperators{
        {{"!=", Operator::kNotEqual},
         {"<=", Operator::kLessEqual},
         {">=", Operator::kGreaterEqual},
         {"=", Operator::kEqual},
         {"<", Operator::kLess},
         {">", Operator::kGreater}}};
    for (const auto& [sign, op] : kOperators) {
      if (!text_.substr(at_).starts_with(sign)) continue;
      comparison.op = op;
      at_ += sign.size();
      return {};
    }
    return failure(at_, "expected one of = != < <= > >=");
  }

  Status readValue(Comparison& comparison) {
    if (at_ < text_.size() && text_[at_] == '"') {
      ASSIGN_OR_RETURN(comparison.text, readString());
      return {};
    }
    const std::size_t start = at_;
    while (at_ < text_.size() && (isWordCharacter(text_[at_]) || text_[at_] == '+')) ++at_;
    const std::optional<double> number = parseDouble(text_.substr(start, at_ - start));
    if (!number || !std::isfinite(*number)) {
      return failure(start, "expected a number, or a string in double quotes");
    }
    comparison.is_number = true;
    comparison.number = *number;
    return {};
  }

  // Whether the value fits the field.
  Status judge(const Comparison& comparison, std::size_t operator_start,
               std::size_t value_start) const {
    const Field field = comparison.field;
    if (field == Field::kTag) return {};
    const bool wants_text =
        field == Field::kName || field == Field::kLabel || field == Field::kType;
    if (wants_text && comparison.is_number) {
      return failure(value_start, "expected a string in double quotes");
    }
    if (!wants_text && !comparison.is_number) return failure(value_start, "expected a number");
    if (field != Field::kType) return {};
    if (comparison.op != Operator::kEqual && comparison.op != Operator::kNotEqual) {
      return failure(operator_start, "a type is compared with = or != only");
    }
    if (!isTypeName(comparison.text)) {
      return failure(value_start,
                     "expected one of SPHERE DISK ANNULUS CIRCLE_DOMAIN TORUS HYPERBOLIC BORDERED");
    }
    return {};
  }

  // Precondition: a double quote is next.
  Result<std::string> readString() {
    const std::size_t start = at_++;
    std::string text;
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        ++at_;
        return text;
      }
      if (text_[at_] == '\\') {
        ++at_;
        const bool known = at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\\');
        if (!known) return failure(at_ - 1, "a backslash goes before \" or \\ only");
      }
      text += text_[at_];
    }
    return failure(start, "this string has no closing quote");
  }

  std::string_view readWord() {
    const std::size_t start = at_;
    while (at_ < text_.size() && isWordCharacter(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }

  void skipBlanks() {
    while (at_ < text_.size() && isBlank(text_[at_])) ++at_;
  }

  Status failure(std::size_t at, std::string_view what) const {
    // Columns count characters: every byte but those that continue a UTF-8 sequence.
    std::size_t column = 1;
    for (std::size_t i = 0; i < at && i < text_.size(); ++i) {
      if ((static_cast<unsigned char>(text_[i]) & 0xC0) != 0x80) ++column;
    }
    return {Reason::kInvalidFilter, "column " + std::to_string(column) + ": " + std::string(what),
            "write for instance: label = \"cup\" AND genus >= 1 AND tags.year != \"2020\""};
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

namespace {

template <typename Operator>
bool decide(Operator op, std::partial_ordering order) {
  switch (op) {
    case Operator::kEqual:
      return order == 0;
    case Operator::kNotEqual:
      return order != 0;
    case Operator::kLess:
      return order < 0;
    case Operator::kLessEqual:
      return order <= 0;
    case Operator::kGreater:
      return order > 0;
    case Operator::kGreaterEqual:
      return order >= 0;
  }
  return false;
}

// A tag that spells no number is unordered to every number: only != holds.
std::partial_ordering compareTag(const std::string& tag, double number) {
  const std::optional<double> value = parseDouble(tag);
  return value ? *value <=> number : std::partial_ordering::unordered;
}

}  // namespace

bool Filter::Comparison::holds(const ShapeRecord& shape) const {
  const TopologyKey& topology = shape.topology;
  const auto counted = [&](double value) { return decide(op, value <=> number); };
  const auto spelled = [&](const std::string& value) { return decide(op, value <=> text); };
  switch (field) {
    case Field::kName:
      return spelled(shape.name);
    case Field::kLabel:
      return spelled(shape.label);
    case Field::kType:
      return spelled(topology.type);
    case Field::kGenus:
      return counted(topology.genus);
    case Field::kBoundaryLoops:
      return counted(topology.boundary_loops);
    case Field::kVertices:
      return counted(topology.vertices);
    case Field::kFaces:
      return counted(topology.faces);
    case Field::kArea:
      return counted(topology.area);
    case Field::kTag: {
      const auto found = shape.tags.find(tag);
      const std::string value = found == shape.tags.end() ? std::string() : found->second;
      return is_number ? decide(op, compareTag(value, number)) : spelled(value);
    }
  }
  return false;
}

Result<Filter> Filter::parse(std::string_view text) {
  return FilterParser(text).parse();
}

bool Filter::matches(const ShapeRecord& shape) const {
  for (const Comparison& comparison : comparisons_) {
    if (!comparison.holds(shape)) return false;
  }
  return true;
}

bool Filter::usesTags() const {
  for (const Comparison& comparison : comparisons_) {
    if (comparison.field == Field::kTag) return true;
  }
  return false;
}

}  // namespace moduli
