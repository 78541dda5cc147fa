#include "core/hyperbolic/orbit_polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

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

/// A convex polygon in Klein's model, where geodesics are straight; the side from corner i to the
/// next lies on the bisector of the element side[i], or on the frame where it is negative.
struct Cell {
  std::vector<Complex> corner{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};
  std::vector<int> side{-1, -1, -1, -1};

  double reach() const {
    double square = 0;
    for (const Complex& k : corner) square = std::max(square, std::norm(k));
    return std::sqrt(square);
  }
};

/// Cuts off what is nearer to g(0) than to 0: Re(conj(u) k) > |w| for the image w of 0 in the
/// direction u. Returns whether that was anything.
bool cutOff(Cell& cell, const Su11& g, int label) {
  const Complex image = g.b / std::conj(g.a);
  const double height = std::abs(image);
  if (height >= cell.reach()) return false;
  const Complex direction = image / height;
  const std::size_t n = cell.corner.size();
  std::vector<double> above(n);
  bool cuts = false;
  for (std::size_t i = 0; i < n; ++i) {
    above[i] = std::real(std::conj(direction) * cell.corner[i]) - height;
    cuts = cuts || above[i] > 1e-12;
  }
  if (!cuts) return false;
  Cell rest{{}, {}};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    const bool in = above[i] <= 0;
    if (in) {
      rest.corner.push_back(cell.corner[i]);
      rest.side.push_back(cell.side[i]);
    }
    if (in == (above[j] <= 0)) continue;
    const double t = above[i] / (above[i] - above[j]);
    rest.corner.push_back(cell.corner[i] + t * (cell.corner[j] - cell.corner[i]));
    rest.side.push_back(in ? label : cell.side[i]);
  }
  cell = std::move(rest);
  return true;
}

Cell cellOf(const Elements& elements) {
  Cell cell;
  for (std::size_t i = 0; i < elements.size(); ++i)
    cutOff(cell, elements[i].shape, static_cast<int>(i));
  return cell;
}

bool isBounded(const Cell& cell) {
  return cell.reach() < 1 - 1e-14;
}

Complex diskPoint(Complex klein) {
  const double k = std::abs(klein);
  return klein / (1 + std::sqrt((1 - k) * (1 + k)));
}

/// Precondition: bounded.
double areaOf(const Cell& cell) {
  double area = 0;
  for (std::size_t i = 0; i < cell.corner.size(); ++i) {
    const Complex p = diskPoint(cell.corner[i]);
    const Complex q = diskPoint(cell.corner[(i + 1) % cell.corner.size()]);
    area -= 2 * std::arg(1.0 - std::conj(p) * q);
  }
  return area;
}

/// The elements of the sides, and their inverses.
Elements neighboursOf(const Cell& cell, const Elements& elements) {
  Elements result;
  const auto add = [&result](WideElement g) {
    for (const WideElement& h : result)
      if (distanceUpToSign(g.shape, h.shape) < kSamePoint * std::abs(g.shape.a)) return;
    result.push_back(std::move(g));
  };
  for (const int side : cell.side) {
    if (side < 0) continue;
    add(elements[side]);
    add(inverseOf(elements[side]));
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

/// The neighbours, those of their products whose bisectors come nearer than `reach` (in Klein's
/// model), and what remains of the generators.
Result<Elements> grow(const Elements& neighbours, const Elements& generators, double reach) {
  Elements result = neighbours;
  const auto add = [&result](WideElement g) -> Status {
    RETURN_IF_ERROR(needTranslation(g.shape));
    if (std::abs(g.shape.b) > kSamePoint) result.push_back(std::move(g));
    return {};
  };
  for (const WideElement& generator : generators) {
    WideElement rest = descend(generator, neighbours);
    RETURN_IF_ERROR(add(inverseOf(rest)));
    RETURN_IF_ERROR(add(std::move(rest)));
  }
  for (const WideElement& g : neighbours) {
    for (const WideElement& h : neighbours) {
      const Su11 shape = g.shape * h.shape;
      if (std::abs(shape.b) > reach * std::abs(shape.a)) continue;
      RETURN_IF_ERROR(add(productOf(g, h)));
    }
  }
  return result;
}

struct Domain {
  Cell cell;
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

/// Products until the area is right. elements: generate the group, with their inverses.
Result<Domain> closeDomain(Context& context, Elements elements, int genus) {
  const Elements generators = elements;
  const double area = 4 * kPi * (genus - 1);
  double last = kUnbounded;
  for (int round = 0; round < 100; ++round) {
    RETURN_IF_ERROR(context.check());
    Cell cell = cellOf(elements);
    Elements neighbours = neighboursOf(cell, elements);
    const double excess = isBounded(cell) ? areaOf(cell) / area - 1 : kUnbounded;
    const bool stays = excess > last / 2;
    last = excess;
    if (std::abs(excess) < kAreaTolerance && (excess < kAreaReached || stays))
      return Domain{std::move(cell), std::move(neighbours), std::abs(excess) * area};
    if (excess < 0) return tooSmall(excess, genus);
    ASSIGN_OR_RETURN(elements, grow(neighbours, generators, cell.reach() * (1 + 1e-9)));
    const bool cuts = std::any_of(elements.begin(), elements.end(), [&cell](const WideElement& g) {
      Cell copy = cell;
      return cutOff(copy, g.shape, 0);
    });
    if (!cuts) break;
  }
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
  return 2 * std::atanh(std::abs(diskPoint(domain.cell.reach())));
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
  polygon.base = renormalized(polygon.base);
  for (WideElement& g : domain.neighbours) {
    polygon.pairings.push_back({g.shape, std::move(g.word)});
    polygon.wide.push_back(g.map);
  }
  for (const Complex& corner : domain.cell.corner) polygon.corners.push_back(diskPoint(corner));
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
