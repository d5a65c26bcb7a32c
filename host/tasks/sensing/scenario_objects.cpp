#include "host/tasks/sensing/scenario_objects.h"

#include <algorithm>
#include <array>
#include <utility>

namespace partita::sensing::scenario {

namespace {

struct Spoke {
  double x;
  double y;
};
constexpr double kHalfRoot3 = 0.86602540378443865;
constexpr std::array<Spoke, 12> kCircle = {{{1, 0},
                                            {kHalfRoot3, 0.5},
                                            {0.5, kHalfRoot3},
                                            {0, 1},
                                            {-0.5, kHalfRoot3},
                                            {-kHalfRoot3, 0.5},
                                            {-1, 0},
                                            {-kHalfRoot3, -0.5},
                                            {-0.5, -kHalfRoot3},
                                            {0, -1},
                                            {0.5, -kHalfRoot3},
                                            {kHalfRoot3, -0.5}}};

Paint varied(const Texture& texture, float gain, std::uint64_t seed) {
  return {&texture, gain, 256.0 * uniform(seed, 1), 256.0 * uniform(seed, 2)};
}

float between(std::uint64_t seed, std::uint64_t stream, double low, double high) {
  return static_cast<float>(low + (high - low) * uniform(seed, stream));
}

/// A disc in the plane across `right`, its front away from the place's origin.
void add_disc(Builder& builder, const Place& place, double r, double u, double f, double radius,
              const Paint& paint) {
  std::array<Vec3, 12> rim;
  for (std::size_t i = 0; i < rim.size(); ++i) {
    rim[i] = place.at(r, u + radius * kCircle[i].y, f + radius * kCircle[i].x);
  }
  builder.face(rim, place.at(0, u, f), paint, place.at(r, u, f), place.forward, place.up);
}

}  // namespace

void add_car(Builder& builder, const Place& place, const TextureSet& t, std::uint64_t seed) {
  const float colour = between(seed, 11, 0.4, 1.7);
  const bool estate = uniform(seed, 12) < 0.5;
  const double half = between(seed, 13, 1.95, 2.2);
  const Paint side{&t.car_side, colour, 128, 0};
  const Paint end{&t.car_front, colour, 0, 0};
  const Paint sheet = varied(t.skin, colour * 0.85F, seed);
  const Paint glass = varied(t.glass, 1.0F, seed);
  const Paint dark = varied(t.rubber, 0.6F, seed);
  builder.box(place, {-0.8, 0.8, -half + 0.15, half - 0.15}, {-0.8, 0.8, -half + 0.1, half - 0.1},
              0.16, 0.32, dark, dark, dark);
  builder.box(place, {-0.86, 0.86, -half, half}, {-0.84, 0.84, -half + 0.06, half - 0.14}, 0.3, 0.9,
              side, end, sheet);
  const double rear = estate ? -half + 0.08 : -half + 0.55;
  builder.box(place, {-0.8, 0.8, rear, 1.05}, {-0.62, 0.62, rear + (estate ? 0.3 : 0.6), 0.3}, 0.9,
              1.44, glass, glass, sheet);
  const Paint hub = varied(t.skin, 0.8F, seed);
  for (const double r : {-0.88, 0.88}) {
    for (const double f : {-1.3, 1.3}) {
      add_disc(builder, place, r, 0.32, f, 0.32, dark);
      add_disc(builder, place, r * 1.006, 0.32, f, 0.19, hub);
    }
  }
}

void add_pedestrian(Builder& builder, const Place& place, const TextureSet& t, std::uint64_t seed,
                    double phase) {
  const double size = between(seed, 21, 0.9, 1.08);
  const Paint trousers = varied(t.cloth, between(seed, 22, 0.25, 0.8), seed);
  const Paint jacket = varied(t.cloth, between(seed, 23, 0.4, 1.7), hash(seed, 24));
  const Paint skin = varied(t.skin, between(seed, 25, 0.7, 1.15), seed);
  const Paint hair = varied(t.rubber, between(seed, 26, 0.7, 2.2), seed);
  const double swing = 0.27 * sine(phase);
  const auto at = [&](double r, double u, double f) {
    return place.at(r * size, u * size, f * size);
  };
  for (const double s : {-1.0, 1.0}) {
    const double step = s * swing;
    builder.beam(at(s * 0.09, 0.06, step), at(s * 0.09, 0.88, 0), 0.15 * size, trousers);
    builder.beam(at(s * 0.09, 0.04, step - 0.05), at(s * 0.09, 0.04, step + 0.17), 0.09, hair);
    builder.beam(at(s * 0.27, 0.82, -0.8 * step), at(s * 0.24, 1.38, 0), 0.1 * size, jacket);
  }
  builder.box(place, {-0.18 * size, 0.18 * size, -0.12 * size, 0.12 * size},
              {-0.23 * size, 0.23 * size, -0.1 * size, 0.1 * size}, 0.82 * size, 1.42 * size,
              jacket, jacket, jacket);
  const Place head{at(0, 1.58, 0.01), place.right, place.up, place.forward};
  builder.ellipsoid(head, 0.1 * size, 0.14 * size, 0.12 * size, skin);
  builder.ellipsoid(head.moved(0, 0.05, -0.03), 0.105 * size, 0.115 * size, 0.115 * size, hair);
}

void add_cyclist(Builder& builder, const Place& place, const TextureSet& t, std::uint64_t seed,
                 double phase) {
  const Paint tyre = varied(t.rubber, 0.8F, seed);
  const Paint frame = varied(t.skin, between(seed, 31, 0.3, 1.3), seed);
  const Paint trousers = varied(t.cloth, between(seed, 32, 0.25, 0.7), seed);
  const Paint jacket = varied(t.cloth, between(seed, 33, 0.5, 1.9), hash(seed, 34));
  const Paint skin = varied(t.skin, 1.0F, seed);
  const Paint helmet = varied(t.skin, between(seed, 35, 0.3, 1.4), hash(seed, 36));
  for (const double f : {-0.52, 0.52}) {
    for (std::size_t i = 0; i < kCircle.size(); ++i) {
      const Spoke a = kCircle[i];
      const Spoke b = kCircle[(i + 1) % kCircle.size()];
      builder.beam(place.at(0, 0.34 + 0.32 * a.y, f + 0.32 * a.x),
                   place.at(0, 0.34 + 0.32 * b.y, f + 0.32 * b.x), 0.05, tyre);
    }
  }
  const Vec3 crank = place.at(0, 0.34, -0.05);
  const Vec3 saddle = place.at(0, 0.92, -0.26);
  const Vec3 fork = place.at(0, 0.95, 0.36);
  const Vec3 hub_rear = place.at(0, 0.34, -0.52);
  const Vec3 hub_front = place.at(0, 0.34, 0.52);
  for (const auto& [a, b] : {std::pair{crank, saddle},
                             {crank, fork},
                             {hub_rear, crank},
                             {hub_rear, saddle},
                             {fork, hub_front}}) {
    builder.beam(a, b, 0.045, frame);
  }
  builder.beam(place.at(-0.27, 1.02, 0.36), place.at(0.27, 1.02, 0.36), 0.04, frame);
  builder.beam(place.at(0, 0.9, -0.24), place.at(0, 1.42, 0.1), 0.32, jacket);
  for (const double s : {-1.0, 1.0}) {
    const double pedal_u = 0.34 + 0.16 * s * sine(phase);
    const double pedal_f = -0.05 + 0.16 * s * cosine(phase);
    const Vec3 knee = place.at(s * 0.11, 0.5 * (pedal_u + 0.95) + 0.06, 0.16 + 0.4 * pedal_f);
    builder.beam(place.at(s * 0.1, 0.93, -0.2), knee, 0.14, trousers);
    builder.beam(knee, place.at(s * 0.11, pedal_u, pedal_f), 0.11, trousers);
    builder.beam(place.at(s * 0.2, 1.36, 0.1), place.at(s * 0.24, 1.03, 0.36), 0.09, jacket);
  }
  const Place head{place.at(0, 1.6, 0.2), place.right, place.up, place.forward};
  builder.ellipsoid(head, 0.1, 0.14, 0.12, skin);
  builder.ellipsoid(head.moved(0, 0.07, -0.01), 0.115, 0.1, 0.14, helmet);
}

void add_tree(Builder& builder, const Place& place, const TextureSet& t, std::uint64_t seed) {
  const double height = between(seed, 41, 2.6, 3.4);
  const double lean = between(seed, 42, -0.15, 0.15);
  builder.beam(place.at(0, 0, 0), place.at(lean, height + 0.6, 0), 0.28,
               varied(t.bark, 1.0F, seed));
  for (std::uint64_t i = 0; i < 3; ++i) {
    const std::uint64_t own = hash(seed, 43, i);
    const double r = lean + between(own, 1, -0.7, 0.7);
    const double f = between(own, 2, -0.7, 0.7);
    const double u = height + 0.9 + 0.75 * static_cast<double>(i);
    const double radius = between(own, 3, 1.1, 1.5) - 0.15 * static_cast<double>(i);
    builder.ellipsoid(place.moved(r, u, f), radius, 0.85 * radius, radius,
                      varied(t.leaves, between(own, 4, 0.7, 1.05), own));
  }
}

void add_lamp(Builder& builder, const Place& place, const TextureSet& t) {
  const Paint steel{&t.bark, 0.75F, 0, 0};
  builder.beam(place.at(0, 0, 0), place.at(0, 5.6, 0), 0.13, steel);
  builder.beam(place.at(0, 5.55, 0), place.at(1.5, 5.75, 0), 0.09, steel);
  builder.beam(place.at(1.2, 5.7, 0), place.at(1.8, 5.78, 0), 0.2, Paint{&t.skin, 1.2F, 0, 0});
  builder.beam(place.at(0, 0, 0), place.at(0, 0.8, 0), 0.24, steel);
}

void add_house(Builder& builder, const Place& place, const TextureSet& t, std::uint64_t seed,
               int side) {
  const auto style = static_cast<std::size_t>(kFacadeStyles * uniform(seed, 51));
  const int bays = uniform(seed, 52) < 0.7 ? 4 : 3;
  const double half = 0.5 * 3.2 * bays;
  const double height = 3.2 * (2 + static_cast<int>(2.6 * uniform(seed, 53)));
  const double depth = side * 9.0;
  const float gain = between(seed, 54, 0.8, 1.15);
  const Paint front{&t.facades[style], gain, bays == 3 ? 64.0 : 0.0, 0.0};
  const Paint roof = varied(t.roof, between(seed, 55, 0.7, 1.1), seed);
  const Builder::Extent walls{std::min(0.0, depth), std::max(0.0, depth), -half, half};
  builder.box(place, walls, walls, 0.0, height, front, front, roof);

  // A gable roof whose ridge runs along the street.
  const double ridge_height = height + between(seed, 56, 1.8, 2.8);
  const Vec3 inside = place.at(0.5 * depth, height, 0);
  for (const double r : {0.0, depth}) {
    const std::array<Vec3, 4> slope = {place.at(r, height, -half), place.at(r, height, half),
                                       place.at(0.5 * depth, ridge_height, half),
                                       place.at(0.5 * depth, ridge_height, -half)};
    builder.face(slope, inside, roof);
  }
  for (const double f : {-half, half}) {
    const std::array<Vec3, 3> gable = {place.at(0, height, f), place.at(depth, height, f),
                                       place.at(0.5 * depth, ridge_height, f)};
    builder.face(gable, inside, front, place.at(0.5 * depth, 0, f), place.right, place.up);
  }
}

}  // namespace partita::sensing::scenario
