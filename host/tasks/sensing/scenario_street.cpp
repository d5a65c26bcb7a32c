#include "host/tasks/sensing/scenario_street.h"

#include <array>
#include <cmath>

#include "host/tasks/sensing/scenario_objects.h"
#include "host/tasks/sensing/scenario_solids.h"

namespace partita::sensing::scenario {

namespace {

// How far before the vehicle things are built, metres, and behind it.
constexpr double kSeeStreet = 230;
constexpr double kSeeHouses = 300;
constexpr double kSeeTrees = 200;
constexpr double kSeeCars = 160;
constexpr double kSeePeople = 100;
constexpr double kSeeShadows = 90;
constexpr double kBehind = 8;

constexpr double kSegment = 2.56;  // of the ground; eight to the road tile's 20.48 m
constexpr double kVerge = 11.4;    // where the paved ground ends
constexpr double kHouseSpacing = 13.7;
constexpr double kTreeSpacing = 15.5;
constexpr double kLampSpacing = 31.0;
constexpr double kParkingSpacing = 6.6;

// Streams of random numbers; the road users' ones also give their ids.
enum : std::uint64_t {
  kHouses = 301,
  kTrees,
  kParked,
  kOncoming,
  kBikes,
  kOncomingBikes,
  kWalkers
};

/// Things of one kind, each moving along the street at one distance from its middle:
/// number k is at z = start + spacing * k + a little + speed * t.
struct Stream {
  std::uint64_t number;
  double across;
  double speed;
  double spacing;
  double start;
  double jitter;
};

class WorldBuilder {
 public:
  WorldBuilder(const Street& street, const TextureSet& textures, std::uint64_t seed, double seconds)
      : street_(street),
        textures_(textures),
        seed_(seed),
        seconds_(seconds),
        z_(Motion::kSpeed * seconds) {
    world_.scene.sky = &textures.clouds;
  }

  World build() {
    add_ground();
    add_fixed();
    add_parked();
    add_moving();
    return std::move(world_);
  }

 private:
  Scene& scene() { return world_.scene; }

  /// A place on the street; side -1 faces against the direction of travel.
  Place place(double z, double across, int side = 1) const {
    const double slope = street_.slope(z);
    const double scale = side / std::sqrt(1.0 + slope * slope);
    Place p;
    const double height = across > kKerb || across < -kKerb ? kPavementHeight : 0.0;
    p.origin = {street_.centre(z) + across, -height, z};
    p.forward = {slope * scale, 0, scale};
    p.right = {scale, 0, -slope * scale};
    return p;
  }

  /// Calls visit(k) for all k with z between behind and `ahead` metres before the vehicle, for
  /// things at z = start + k * spacing, with one to spare at either end.
  template <class Visit>
  void each(double start, double spacing, double ahead, Visit visit) const {
    const auto first = static_cast<std::int64_t>(std::floor((z_ - kBehind - start) / spacing)) - 1;
    const auto last = static_cast<std::int64_t>(std::floor((z_ + ahead - start) / spacing)) + 1;
    for (std::int64_t k = first; k <= last; ++k) visit(k);
  }

  void add_ground();
  void add_strip(std::int64_t segment, double left, double right, double height);
  void add_kerb(std::int64_t segment, double across, int side);
  void add_fixed();
  void add_parked();
  void add_moving();
  void add_stream(const Stream& stream, ObjectClass kind, double ahead);
  void add_user(ObjectClass kind, int id, const Place& at, std::uint64_t seed, double phase);
  void shade(std::size_t first_solid, double z) {
    if (z - z_ < kSeeShadows) cast_shadow(scene(), first_solid);
  }

  const Street& street_;
  const TextureSet& textures_;
  std::uint64_t seed_;
  double seconds_;
  double z_;
  World world_;
};

void WorldBuilder::add_strip(std::int64_t segment, double left, double right, double height) {
  const double z0 = kSegment * static_cast<double>(segment);
  const double z1 = kSegment * static_cast<double>(segment + 1);
  const double c0 = street_.centre(z0);
  const double c1 = street_.centre(z1);
  const double texels = textures_.road.texels_per_metre();
  Face f;
  f.first = static_cast<std::uint32_t>(scene().vertices.size());
  f.count = 4;
  f.normal = {0, -1, 0};
  f.surface.texture = &textures_.road;
  f.surface.origin = {c0, -height, z0};
  f.surface.u_axis = {texels, 0, -texels * ((c1 - c0) / (z1 - z0))};
  f.surface.v_axis = {0, 0, texels};
  f.surface.u0 = 512;
  f.surface.v0 = static_cast<double>(((segment % 8) + 8) % 8) * kSegment * texels;
  scene().vertices.insert(scene().vertices.end(), {{c0 + left, -height, z0},
                                                   {c1 + left, -height, z1},
                                                   {c1 + right, -height, z1},
                                                   {c0 + right, -height, z0}});
  scene().ground.push_back(f);
}

void WorldBuilder::add_kerb(std::int64_t segment, double across, int side) {
  const double z0 = kSegment * static_cast<double>(segment);
  const double z1 = kSegment * static_cast<double>(segment + 1);
  const double x0 = street_.centre(z0) + across;
  const double x1 = street_.centre(z1) + across;
  const std::array<Vec3, 4> quad = {
      {{x0, 0, z0}, {x1, 0, z1}, {x1, -kPavementHeight, z1}, {x0, -kPavementHeight, z0}}};
  const Paint stone{&textures_.cloth, 1.15F, 60.0 * z0 - 256.0 * std::floor(60.0 * z0 / 256.0), 0};
  Builder(scene(), -1).face(quad, Vec3{x0 + side, 0, z0}, stone);
}

void WorldBuilder::add_ground() {
  each(0.0, kSegment, kSeeStreet, [this](std::int64_t segment) {
    add_strip(segment, -kKerb, kKerb, 0.0);
    add_strip(segment, -kVerge, -kKerb, kPavementHeight);
    add_strip(segment, kKerb, kVerge, kPavementHeight);
    add_kerb(segment, -kKerb, -1);
    add_kerb(segment, kKerb, 1);
  });
  constexpr double kFar = 900;
  Face meadow;  // below all, out to the horizon
  meadow.first = static_cast<std::uint32_t>(scene().vertices.size());
  meadow.count = 4;
  meadow.normal = {0, -1, 0};
  meadow.surface.texture = &textures_.leaves;
  meadow.surface.u_axis = {30, 0, 0};
  meadow.surface.v_axis = {0, 0, 30};
  scene().vertices.insert(scene().vertices.end(), {{-kFar, 0.05, z_ - 20},
                                                   {-kFar, 0.05, z_ + kFar},
                                                   {kFar, 0.05, z_ + kFar},
                                                   {kFar, 0.05, z_ - 20}});
  scene().ground.push_back(meadow);
}

void WorldBuilder::add_fixed() {
  Builder builder(scene(), -1);
  for (const int side : {-1, 1}) {
    const std::uint64_t own = hash(seed_, kHouses, key(side));
    each(5.0 * side, kHouseSpacing, kSeeHouses, [&](std::int64_t k) {
      const double z = 5.0 * side + kHouseSpacing * static_cast<double>(k);
      const double setback = 0.9 * uniform(own, 1, key(k));
      const std::size_t first = scene().solids.size();
      add_house(builder, place(z, side * (kPavementEdge + setback)), textures_,
                hash(own, 2, key(k)), side);
      shade(first, z);
    });
    each(2.0 * side, kTreeSpacing, kSeeTrees, [&](std::int64_t k) {
      const std::uint64_t tree = hash(seed_, kTrees, key(side), key(k));
      if (uniform(tree, 1) < 0.25) return;
      const double z =
          2.0 * side + kTreeSpacing * (static_cast<double>(k) + 0.3 * uniform(tree, 2));
      const std::size_t first = scene().solids.size();
      add_tree(builder, place(z, side * 6.2), textures_, tree);
      shade(first, z);
    });
    each(9.0 * side, kLampSpacing, kSeeTrees, [&](std::int64_t k) {
      const double z = 9.0 * side + kLampSpacing * static_cast<double>(k);
      const std::size_t first = scene().solids.size();
      add_lamp(builder, place(z, side * 5.75, -side), textures_);
      shade(first, z);
    });
  }
}

void WorldBuilder::add_user(ObjectClass kind, int id, const Place& at, std::uint64_t seed,
                            double phase) {
  const std::size_t first = scene().solids.size();
  Builder builder(scene(), static_cast<std::int32_t>(world_.users.size()));
  if (kind == ObjectClass::car) {
    add_car(builder, at, textures_, seed);
  } else if (kind == ObjectClass::pedestrian) {
    add_pedestrian(builder, at, textures_, seed, phase);
  } else {
    add_cyclist(builder, at, textures_, seed, phase);
  }
  world_.users.push_back({kind, id, at.at(0, kind == ObjectClass::car ? 0.75 : 0.85, 0)});
  shade(first, at.origin.z);
}

/// Ids of a kind of road user are counted from the stream's own thousands, whatever k.
int id_of(std::uint64_t stream, std::int64_t k) {
  const auto within = static_cast<int>(((k % 100'000) + 100'000) % 100'000);
  return static_cast<int>(stream - kParked) * 100'000 + within;
}

void WorldBuilder::add_parked() {
  for (const int side : {-1, 1}) {
    each(1.5 * side, kParkingSpacing, kSeeCars, [&](std::int64_t k) {
      const std::uint64_t own = hash(seed_, kParked, key(side), key(k));
      if (uniform(own, 1) < 0.42) return;
      const double z =
          1.5 * side + kParkingSpacing * static_cast<double>(k) + uniform(own, 2) - 0.5;
      const double across = side * (4.25 + 0.12 * uniform(own, 3));
      add_user(ObjectClass::car, id_of(kParked, 2 * k + (side > 0 ? 1 : 0)), place(z, across, side),
               own, 0.0);
    });
  }
}

void WorldBuilder::add_stream(const Stream& s, ObjectClass kind, double ahead) {
  each(s.start + s.speed * seconds_, s.spacing, ahead, [&](std::int64_t k) {
    const std::uint64_t own = hash(seed_, s.number, key(k));
    const double z = s.start + s.speed * seconds_ + s.spacing * static_cast<double>(k) +
                     s.jitter * (2.0 * uniform(own, 1) - 1.0);
    const double across =
        s.across + (kind == ObjectClass::pedestrian ? 0.9 * uniform(own, 2) : 0.0);
    const double phase = (kind == ObjectClass::pedestrian ? 4.2 : 2.6) * z + 6.0 * uniform(own, 3);
    const double wrapped = phase - 6.28318530717958648 * std::floor(phase / 6.28318530717958648);
    add_user(kind, id_of(s.number, k), place(z, across, s.speed < 0 ? -1 : 1), own, wrapped);
  });
}

void WorldBuilder::add_moving() {
  add_stream({kOncoming, -1.7, -8.0, 55.0, 44.0, 14.0}, ObjectClass::car, kSeeCars);
  add_stream({kBikes, 3.0, 4.4, 58.0, 15.0, 4.0}, ObjectClass::cyclist, kSeePeople);
  add_stream({kOncomingBikes, -3.0, -4.2, 64.0, 33.0, 8.0}, ObjectClass::cyclist, kSeePeople);
  std::uint64_t number = kWalkers;
  for (const double across : {-8.2, -7.4, 6.7, 7.6}) {
    const double speed = number % 2 == 0 ? 1.35 : -1.2;
    add_stream({number, across, speed, 21.0, 5.0 * static_cast<double>(number % 5), 8.0},
               ObjectClass::pedestrian, kSeePeople);
    ++number;
  }
  // The car ahead comes and goes a little.
  const double gap = 23.0 + 3.0 * sine(0.4 * seconds_);
  add_user(ObjectClass::car, id_of(number, 0), place(z_ + gap, 1.7), hash(seed_, number), 0.0);
}

}  // namespace

World build_world(const Street& street, const TextureSet& textures, std::uint64_t seed,
                  double seconds) {
  return WorldBuilder(street, textures, seed, seconds).build();
}

}  // namespace partita::sensing::scenario
