#pragma once

#include "engine/archive.hpp"
#include "engine/world.hpp"
#include "scenarios/ballast_box/box_settings.hpp"
#include "scenarios/rocks/grading.hpp"

#include <array>
#include <string>
#include <vector>

namespace bris {

/// A sensor rock: where it is placed, and by which name results call it.
struct BoxSensor {
    std::string name;
    EntityId body;
    Vec3 place;         ///< m; z is found when it is placed
    std::size_t course; ///< is placed on top of this course
};

/// Bodies of a ballast box.
struct BoxBodies {
    static constexpr auto name = "box_bodies";
    std::array<std::vector<EntityId>, courses.size()> rocks; ///< by course
    std::vector<BoxSensor> sensors;
    std::vector<EntityId> ties, subgrade;
    EntityId plate = nobody, bladder = nobody;
    std::uint32_t rock = 0;        ///< material
    std::vector<Material> hard;    ///< materials at full stiffness
    double solid_volume = 0;       ///< m3, of all rocks
    double truncated_fraction = 0; ///< mass fraction of the grading that is left out
};

/// How far the test has come; State.
struct BoxState {
    static constexpr auto name = "box";
    static constexpr bool is_state = true;
    double stage = 0;            ///< of hardening
    double began = 0;            ///< s, of the phase
    double surface = 0;          ///< m, of the last lift after its compaction
    double tie_1 = 0, tie_2 = 0; ///< m, heights of the ties when the cycles begin
    double bladder = 0;          ///< m, y of the bladder when the cycles begin
    void save(Archive& archive) const {
        put_fields(archive, "box", std::tie(stage, began, surface, tie_1, tie_2, bladder));
    }
    void load(const Archive& archive) {
        get_fields(archive, "box", std::tie(stage, began, surface, tie_1, tie_2, bladder));
    }
};

/// Makes the world of a box: subgrade, sides, bladder, compaction plate, ties, sensor rocks, and
/// all rocks, parked above the box until they are poured. Throws InputError.
World make_box_world(const BallastBox& box, std::uint64_t seed);

/// Sets the stiffness of all materials to a fraction of the full one, and a limit on restitution.
void set_softness(World& world, double fraction, double most_restitution = 1);

/// Makes a parked body free, at a place and at rest, or fixes a free one there.
void release(World& world, EntityId body, const Vec3& position);
void park(World& world, EntityId body, const Vec3& position);

/// Places the full bladder above the first lift, higher than planned where rocks reach higher.
void place_bladder(World& world, const BoxSizes& sizes);

/// Height (m) of the highest point of a rock's sphere whose centre lies within `radius` of (x, y);
/// `least` where there is none.
double surface_height(const World& world, double x, double y, double radius, double least);
/// The same within a rectangle.
double surface_height(const World& world, const Vec3& low, const Vec3& high, double least);

/// Throws InputError, naming --tie-level, if the tie at `x` (m) would overlap a rock by more than
/// the limit of overlap with its lower side at `level` (m). `surface`: m, named in the message.
void check_tie(const World& world, const BoxSizes& sizes, double x, double level, double surface);

} // namespace bris
