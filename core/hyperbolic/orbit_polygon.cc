#include "core/hyperbolic/orbit_polygon.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/hyperbolic/klein_cell.h"

namespace moduli {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// An orbit point this near to 0 is 0 itself, up to rounding.
constexpr double kSamePoint = 1e-6;
constexpr double kAreaTolerance = 1e-6;
/// Areas that agree to this need no further products, which would cut off slivers.
constexpr double kAreaReached = 1e-10;
/// Rounding of the generators, more than this leaves no doubt that they are another group's.
constexpr double kAreaOfRounding = 1e-2;
/// In Klein's model: distances of 6.
constexpr double kFar = 1 - 1e-5;
/// Corners are right to 1e-16 e^{2 r}, and axes through them must be told apart.
constexpr double kFarthest = 10.5;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// As GroupElement, in 113 bits: products of elements that move 0 by d lose a factor e^{d} each
/// time, and a surface of genus 12 needs many with d = 12.
struct WideElement {
  WideSu11 map;
  Word word;
  Su11 shape;  ///< The same in doubles: enough to see what a product is worth.
};
using Elements = std::vector<WideElement>;

WideElement elementOf(const WideSu11& map, Word word) {
  return {map, std::move(word), rounded(map)};
}

WideElement inverseOf(const WideElement& g) {
  return elementOf(inverse(g.map), inverseWord(g.word));
}

WideElement productOf(const WideElement& g, const WideElement& h) {
  Word word = g.word;
  word.insert(word.end(), h.word.begin(), h.word.end());
  return elementOf(renormalized(g.map * h.map), reduceWord(word));
}

KleinCell cellOf(const Elements& elements) {
  KleinCell cell;
  for (std::size_t i = 0; i < elements.size(); ++i)
    cutOff(cell, elements[i].map, elements[i].shape, static_cast<int>(i));
  return cell;
}

/// The elements of the sides, and their inverses. The cell's sides are renumbered to them.
Elements neighboursOf(KleinCell& cell, const Elements& elements) {
  Elements result;
  const auto add = [&result](WideElement g) {
    for (std::size_t k = 0; k < result.size(); ++k)
      if (sameElement(g.shape, result[k].shape)) return static_cast<int>(k);
    result.push_back(std::move(g));
    return static_cast<int>(result.size()) - 1;
  };
  for (int& side : cell.side) {
    if (side < 0) continue;
    const WideElement& g = elements[side];
    side = add(g);
    add(inverseOf(g));
  }
  return result;
}

/// g, multiplied from the left by neighbours as long as that brings g(0) nearer to 0.
WideElement descend(WideElement g, const Elements& neighbours) {
  for (;;) {
    const WideElement* best = nullptr;
    double least = std::abs(g.shape.b) * (1 - 1e-12) - kSamePoint / 10;
    for (const WideElement& s : neighbours) {
      const double b = std::abs((s.shape * g.shape).b);
      if (b < least) {
        least = b;
        best = &s;
      }
    }
    if (best == nullptr) return g;
    g = productOf(*best, g);
  }
}

/// Fails unless g is 1 or shifts along an axis.
Status needTranslation(const Su11& g) {
  if (distanceToUnit(g) < 10 * kSamePoint || std::abs(g.a.real()) > 1) return {};
  return {Reason::kInvalidOption, "an element of the group has half trace " +
                                      std::to_string(g.a.real()) +
                                      ", but a closed surface's elements are translations"};
}

/// A translation much shorter than the distances of the polygon: it takes hundreds of steps to
/// where its axis passes another corner.
constexpr double kShort = 0.25;

/// Multiplies elements from the left by powers of a short one.
class Turner {
 public:
  explicit Turner(const WideElement& c)
      : short_(c), frame_(frameOf(axisOf(c.shape))), length_(translationLength(c.shape)) {}

  /// The power of it that brings g(0) nearest to 0: its images lie beside the axis.
  int turnsOf(const Su11& g) const {
    return static_cast<int>(std::lround(
        (alongDiameter(inverse(frame_)) - alongDiameter(inverse(frame_) * g)) / length_));
  }
  Su11 turned(const Su11& g, int turns) const {
    return frame_ * translation(turns * length_) * inverse(frame_) * g;
  }
  WideElement turned(WideElement g, int turns) const {
    WideElement power = turns > 0 ? short_ : inverseOf(short_);
    for (turns = std::abs(turns); turns > 0; turns /= 2) {
      if (turns % 2 != 0) g = productOf(power, g);
      if (turns > 1) power = productOf(power, power);
    }
    return g;
  }

 private:
  const WideElement& short_;
  Su11 frame_;
  double length_;
};

/// Whether descend leads to 1, as far as doubles tell.
bool descendsToUnit(Su11 g, const Elements& neighbours) {
  constexpr double kLargest = 1e5;  // Its products are right to 1e-16 kLargest^2.
  if (std::abs(g.b) > kLargest) return false;
  for (bool nearer = true; nearer;) {
    nearer = false;
    Su11 best = g;
    for (const WideElement& s : neighbours) {
      const Su11 product = s.shape * g;
      if (std::norm(product.b) >= std::norm(best.b)) continue;
      best = product;
      nearer = true;
    }
    g = best;
  }
  return std::abs(g.b) < kSamePoint;
}

/// The neighbours, and those that cut their cell of their products, of what remains of the
/// generators, and of what powers of short neighbours make of all these. Nothing else can be a
/// side: the cell only gets smaller.
class Growth {
 public:
  Growth(const KleinCell& cell, const Elements& neighbours)
      : cell_(cell), neighbours_(neighbours), result_(neighbours) {
    for (const WideElement& g : neighbours)
      if (translationLength(g.shape) < kShort) turners_.emplace_back(g);
  }

  Result<Elements> run(const Elements& generators) {
    for (const WideElement& g : neighbours_)
      RETURN_IF_ERROR(addTurned(g.shape, sizeOf(g), [&g] { return g; }));
    for (const WideElement& generator : generators) {
      if (turners_.empty() && descendsToUnit(generator.shape, neighbours_)) continue;
      const WideElement rest = descend(generator, neighbours_);
      for (const WideElement& g : {rest, inverseOf(rest)}) {
        RETURN_IF_ERROR(add(g));
        RETURN_IF_ERROR(addTurned(g.shape, sizeOf(g), [&g] { return g; }));
      }
    }
    for (const WideElement& g : neighbours_) {
      for (const WideElement& h : neighbours_) {
        const Su11 shape = g.shape * h.shape;
        const double size = sizeOf(g) * sizeOf(h);
        const auto product = [&] { return productOf(g, h); };
        if (mayCut(shape, size)) RETURN_IF_ERROR(add(product()));
        RETURN_IF_ERROR(addTurned(shape, size, product));
      }
    }
    return std::move(result_);
  }

 private:
  static double sizeOf(const WideElement& g) { return std::sqrt(std::norm(g.shape.a)); }

  /// size: the product of those of the factors, which rounding is of.
  bool mayCut(const Su11& g, double size) const {
    return mayCutOff(cell_, g, 1e-15 * (1 + size / std::sqrt(std::norm(g.a))));
  }

  Status add(WideElement g) {
    RETURN_IF_ERROR(needTranslation(g.shape));
    if (std::abs(g.shape.b) > kSamePoint && cutsOff(cell_, g.map, g.shape))
      result_.push_back(std::move(g));
    return {};
  }

  template <typename Make>
  Status addTurned(const Su11& shape, double size, const Make& make) {
    for (const Turner& turner : turners_) {
      const int turns = turner.turnsOf(shape);
      if (std::abs(turns) < 2) continue;
      const Su11 turned = turner.turned(shape, turns);
      const double power = std::sqrt(std::norm(turned.a)) + size;
      if (mayCut(turned, size * power)) RETURN_IF_ERROR(add(turner.turned(make(), turns)));
    }
    return {};
  }

  const KleinCell& cell_;
  const Elements& neighbours_;
  std::vector<Turner> turners_;
  Elements result_;
};

struct Domain {
  KleinCell cell;
  Elements neighbours;
  double area_error = 0;
};

/// Why a cell cut out by elements of a group may be smaller than the group's.
Status tooSmall(double excess, int genus) {
  if (excess < -kAreaOfRounding)
    return {Reason::kInvalidOption,
            "the elements cut out less than the area of genus " + std::to_string(genus)};
  return {Reason::kResidualTooLarge,
          "rounding of the generators is off the area by " + std::to_string(-excess),
          "give generators that move the centre of the disk less"};
}

/// Not OK where an element is so short that the polygon, up to `reach` in Klein's model, reaches
/// further across its collar than doubles hold.
Status collarTooLong(const Elements& elements, double reach) {
  double length = kShort;
  for (const WideElement& g : elements) length = std::min(length, translationLength(g.shape));
  if (length >= kShort || reach < std::tanh(kFarthest)) return {};
  return {Reason::kResidualTooLarge,
          "the collar of a closed geodesic of length " + shortestDouble(length) +
              " reaches to distance " + shortestDouble(std::asinh(1 / std::sinh(length / 2))) +
              " on either side; with it the polygon reaches further than " +
              shortestDouble(kFarthest) + ", where doubles end",
          "take a surface with fewer or longer short geodesics"};
}

/// Products until the area is right. elements: generate the group, with their inverses.
Result<Domain> closeDomain(Context& context, Elements elements, int genus) {
  const Elements generators = elements;
  const double area = 4 * kPi * (genus - 1);
  double last = kUnbounded;
  double reach = 0;
  for (int round = 0; round < 100; ++round) {
    RETURN_IF_ERROR(context.check());
    KleinCell cell = cellOf(elements);
    Elements neighbours = neighboursOf(cell, elements);
    const double excess = isBounded(cell) ? areaOf(cell) / area - 1 : kUnbounded;
    const bool stays = excess > last / 2;
    last = excess;
    const bool closed = std::abs(excess) < kAreaTolerance;
    const auto domain = [&] {
      return Domain{std::move(cell), std::move(neighbours), std::abs(excess) * area};
    };
    // Whole sides in the middle of a collar are smaller than the rounding of the area.
    const bool far = cell.reach > kFar;
    if (closed && !far && (excess < kAreaReached || stays)) return domain();
    reach = cell.reach;
    const std::size_t sides = neighbours.size();
    Result<Elements> grown = Growth(cell, neighbours).run(generators);
    if (!grown.ok() || (excess < 0 && !closed)) {
      RETURN_IF_ERROR(collarTooLong(generators, reach));
      return grown.ok() ? tooSmall(excess, genus) : grown.status();
    }
    elements = *std::move(grown);
    if (elements.size() > sides && round < 99) continue;
    if (closed) return domain();
    break;
  }
  RETURN_IF_ERROR(collarTooLong(generators, reach));
  return Status(
      Reason::kInvalidOption,
      "the elements generate no group of a closed surface of genus " + std::to_string(genus));
}

/// The shortest of g h, g h^-1, h g and h^-1 g, if it moves 0 less than g by a thousandth.
bool shortenBy(WideElement& g, const WideElement& h) {
  const WideElement back = inverseOf(h);
  const std::pair<const WideElement*, const WideElement*> products[] = {
      {&g, &h}, {&g, &back}, {&h, &g}, {&back, &g}};
  double least = std::abs(g.shape.b) * 0.999;
  const std::pair<const WideElement*, const WideElement*>* best = nullptr;
  for (const auto& product : products) {
    const double b = std::abs((product.first->shape * product.second->shape).b);
    if (b < least) {
      least = b;
      best = &product;
    }
  }
  if (best == nullptr) return false;
  g = productOf(*best->first, *best->second);
  return true;
}

/// Generators that move 0 less, by products of two: rounding is multiplied by the elements that are
/// multiplied, so that long ones must go before more is done with them. Those that end at 1 go.
void shorten(Elements& generators) {
  const auto byDisplacement = [](const WideElement& g, const WideElement& h) {
    return std::abs(g.shape.b) < std::abs(h.shape.b);
  };
  bool shorter = true;
  while (shorter) {
    shorter = false;
    std::stable_sort(generators.begin(), generators.end(), byDisplacement);
    for (std::size_t i = generators.size(); i-- > 0;) {
      for (std::size_t k = 0; k < i; ++k)
        shorter = shortenBy(generators[i], generators[k]) || shorter;
    }
    std::erase_if(generators,
                  [](const WideElement& g) { return std::abs(g.shape.b) < kSamePoint; });
  }
}

void moveBase(Elements& elements, const Su11& move) {
  const WideSu11 wide = widened(move);
  for (WideElement& g : elements) {
    g = elementOf(renormalized(inverse(wide) * g.map * wide), std::move(g.word));
  }
}

double squaredSines(const Elements& elements, const Su11& move) {
  double sum = 0;
  for (const WideElement& g : elements) sum += std::norm((inverse(move) * g.shape * move).b);
  return sum;
}

/// Down the convex function sum |b|^2 of the base point: a first one from which the generators are
/// not far, wherever 0 was.
Su11 firstBase(Elements& elements) {
  Su11 base;
  double step = 1;
  for (int round = 0; round < 200 && step > 0.05; ++round) {
    Complex gradient = 0;
    for (const WideElement& g : elements) gradient -= Complex(0, g.shape.a.imag()) * g.shape.b;
    if (std::abs(gradient) == 0) break;
    const Su11 move = translationTo(-gradient / std::abs(gradient) * std::tanh(step / 2));
    if (squaredSines(elements, move) < squaredSines(elements, Su11{})) {
      moveBase(elements, move);
      base = base * move;
      step *= 2;
    } else {
      step /= 2;
    }
  }
  return base;
}

double reachOf(const Domain& domain) {
  double reach = 0;
  for (const KleinPoint& corner : domain.cell.corner)
    reach = std::max(reach, 2 * std::atanh(std::abs(diskPoint(corner))));
  return reach;
}

/// Moves the base point by a pattern of steps, ever smaller, to where the polygon reaches less far.
Result<Domain> improveBase(Context& context, Domain domain, int genus, Su11& base) {
  constexpr int kDirections = 6;
  double reach = reachOf(domain);
  for (double step = reach / 3; step > 0.05; step /= 2) {
    bool better = true;
    for (int round = 0; better && round < 8; ++round) {
      better = false;
      for (int k = 0; k < kDirections; ++k) {
        const Su11 move =
            translationTo(std::polar(std::tanh(step / 2), 0.1 + 2 * kPi * k / kDirections));
        Elements moved = domain.neighbours;
        moveBase(moved, move);
        ASSIGN_OR_RETURN(Domain candidate, closeDomain(context, std::move(moved), genus));
        if (reachOf(candidate) > reach - 1e-3) continue;
        reach = reachOf(candidate);
        domain = std::move(candidate);
        base = base * move;
        better = true;
        break;
      }
    }
  }
  return domain;
}

}  // namespace

Result<OrbitPolygon> orbitPolygon(Context& context, const std::vector<Su11>& generators,
                                  int genus) {
  std::vector<WideSu11> wide;
  for (const Su11& g : generators) wide.push_back(widened(g));
  return orbitPolygon(context, wide, genus);
}

Result<OrbitPolygon> orbitPolygon(Context& context, const std::vector<WideSu11>& generators,
                                  int genus) {
  if (genus < 2 || generators.empty())
    return Status(Reason::kInvalidOption,
                  "a hyperbolic surface has genus 2 or more, and generators");
  const Context::Stage stage(context, "orbit polygon");
  Elements elements;
  for (std::size_t k = 0; k < generators.size(); ++k) {
    WideElement element = elementOf(generators[k], {static_cast<int>(k) + 1});
    RETURN_IF_ERROR(needTranslation(element.shape));
    if (distanceToUnit(element.shape) >= kSamePoint) elements.push_back(std::move(element));
  }
  OrbitPolygon polygon;
  polygon.genus = genus;
  polygon.base = firstBase(elements);
  shorten(elements);
  polygon.base = polygon.base * firstBase(elements);
  for (std::size_t k = elements.size(); k-- > 0;) elements.push_back(inverseOf(elements[k]));
  ASSIGN_OR_RETURN(Domain domain, closeDomain(context, std::move(elements), genus));
  ASSIGN_OR_RETURN(domain, improveBase(context, std::move(domain), genus, polygon.base));
  RETURN_IF_ERROR(collarTooLong(domain.neighbours, domain.cell.reach));
  polygon.base = renormalized(polygon.base);
  for (WideElement& g : domain.neighbours) {
    polygon.pairings.push_back({g.shape, std::move(g.word)});
    polygon.wide.push_back(g.map);
  }
  polygon.sides = domain.cell.side;
  for (const KleinPoint& corner : domain.cell.corner) polygon.corners.push_back(diskPoint(corner));
  polygon.radius = reachOf(domain);
  polygon.area_error = domain.area_error;
  polygon.separation = std::numeric_limits<double>::infinity();
  for (const GroupElement& g : polygon.pairings)
    polygon.separation = std::min(polygon.separation, displacement(g.map));
  return polygon;
}

Su11 inGivenCoordinates(const OrbitPolygon& polygon, const Su11& element) {
  return renormalized(polygon.base * element * inverse(polygon.base));
}

Su11 elementOfWord(const std::vector<Su11>& generators, const Word& word) {
  Su11 product;
  for (const int letter : word) {
    const Su11& g = generators[std::abs(letter) - 1];
    product = renormalized(product * (letter > 0 ? g : inverse(g)));
  }
  return product;
}

bool meetsPolygon(const OrbitPolygon& polygon, const Axis& axis, double slack) {
  bool left = false, right = false;
  for (const Complex& corner : polygon.corners) {
    const double side = sideOf(axis, corner);
    left = left || side > -slack;
    right = right || side < slack;
  }
  return left && right;
}

}  // namespace moduli
