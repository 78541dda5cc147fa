#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.h"
#include "server/store/shape_record.h"

namespace moduli {

/// A condition on shapes, as users write it:
///
///   label = "cup" AND genus >= 1 AND tags.year != "2020"
///
///   filter     = [ comparison { "AND" comparison } ]
///   comparison = field operator value
///   field      = "name" | "label" | "type" | "genus" | "boundary_loops" | "vertices" | "faces"
///              | "area" | "tags." ( KEY | string )      KEY of letters digits "_" "-" "."
///   operator   = "=" | "!=" | "<" | "<=" | ">" | ">="
///   value      = string | number
///   string     = text in double quotes, \" and \\ for themselves
///
/// Numbers compare as numbers, strings byte by byte. name, label and type take strings (type only
/// = and != and a known type), the counts and area take numbers. Tags take either: against a number
/// a tag counts as the number that it spells, and one that spells none differs from every number. A
/// missing tag is the empty string. Immutable; safe to use from several threads.
class Filter {
 public:
  /// Lets every shape through.
  Filter() = default;

  /// An empty or blank text lets every shape through. Fails with kInvalidFilter; the message names
  /// the column, counted from 1 in characters.
  static Result<Filter> parse(std::string_view text);

  /// Looks at name, label, tags and topology of `shape`, nothing else.
  bool matches(const ShapeRecord& shape) const;

  bool matchesAll() const { return comparisons_.empty(); }
  bool usesTags() const;

 private:
  friend class FilterParser;

  enum class Field { kName, kLabel, kType, kGenus, kBoundaryLoops, kVertices, kFaces, kArea, kTag };
  enum class Operator { kEqual, kNotEqual, kLess, kLessEqual, kGreater, kGreaterEqual };

  struct Comparison {
    Field field = Field::kName;
    std::string tag;  ///< Key, for kTag.
    Operator op = Operator::kEqual;
    bool is_number = false;
    double number = 0;
    std::string text;

    bool holds(const ShapeRecord& shape) const;
  };

  std::vector<Comparison> comparisons_;
};

}  // namespace moduli
