#pragma once

#include "engine/archive.hpp"
#include "engine/world.hpp"
#include "scenarios/ballast_box/box_settings.hpp"
#include "scenarios/rocks/grading.hpp"

#include <array>
#include <string>
#include <tuple>
#include <vector>

namespace bris {

/// A sensor rock: where it is placed, and by which name results call it.
struct BoxSensor {
    std::string name;
    EntityId body;
    Vec3 place;         ///< m; z is found when it is placed
    std::size_t course; ///< is placed on top of this course
};

/// A rock that will be poured: its shape among BoxBodies::shapes, and its sieve size, scaled, m.
struct PlannedRock {
    std::size_t shape;
    double sieve;
};

/// A plate that compacts lifts, and the corners of the rectangle below it, m.
struct CompactionPlate {
    EntityId body;
    Vec3 low, high;
};

/// Bodies of a ballast box.
struct BoxBodies {
    static constexpr auto name = "box_bodies";
    std::array<std::vector<EntityId>, courses.size()> rocks;      ///< by course
    std::array<std::vector<PlannedRock>, courses.size()> planned; ///< the same, as they are made
    std::vector<Clump> shapes;                                    ///< of rocks
    std::vector<BoxSensor> sensors;
    std::vector<EntityId> ties, subgrade;
    EntityId bladder = nobody;
    std::array<std::vector<CompactionPlate>, 2> plates; ///< for the first lift, for the others
    std::uint32_t rock = 0,
                  shell = 0;       ///< materials of rocks and, in a bay another, of sensor rocks
    std::vector<Material> hard;    ///< materials at full stiffness
    double wet_friction = 1;       ///< factor on the friction of wet stones
    double truncated_fraction = 0; ///< mass fraction of the grading that is left out

    std::size_t number_of_rocks() const {
        std::size_t number = 0;
        for (const auto& course : rocks) number += course.size();
        return number;
    }
};

/// How far the test has come; State.
struct BoxState {
    static constexpr auto name = "box";
    static constexpr bool is_state = true;
    double stage = 0;                 ///< within the phase
    double began = 0;                 ///< s, beginning of the phase or of its stage
    double friction = 1;              ///< factor on friction while a lift is compacted
    double calm = 0;                  ///< checks in a row that found the box at rest
    std::array<double, 3> surface{};  ///< m, of each lift after its compaction
    std::array<double, 3> porosity{}; ///< of each lift after its compaction
    double bed_porosity = 0;          ///< of all lifts, when the cycles begin
    double tie_1 = 0, tie_2 = 0;      ///< m, heights of the ties when the cycles begin
    double bladder = 0;               ///< m, y of the bladder when the cycles begin
    double seat_ratio = 0;            ///< unbalanced force ratio when the cycles begin
    double seat_support = 0;          ///< share of the loads that the ballast carries then
    /// N, m: support and height of the tie below the last axle of a train; 0: it has not come yet.
    double pressed_support = 0, pressed_height = 0;
    double bed_stiffness = 0; ///< N/m, of a whole tie, as the last train found it; 0: unknown
    double wet = 0;           ///< 1: the stones are
    static auto fields(auto& s) {
        return std::tie(s.stage, s.began, s.friction, s.calm, s.surface[0], s.surface[1],
                        s.surface[2], s.porosity[0], s.porosity[1], s.porosity[2], s.bed_porosity,
                        s.tie_1, s.tie_2, s.bladder, s.seat_ratio, s.seat_support,
                        s.pressed_support, s.pressed_height, s.bed_stiffness, s.wet);
    }
    void save(Archive& archive) const { put_fields(archive, "box", fields(*this)); }
    void load(const Archive& archive) { get_fields(archive, "box", fields(*this)); }
};

/// Makes the world of a box: subgrade, sides, bladder, compaction plate, ties, sensor rocks, and
/// all rocks, parked above the box until they are poured. Throws InputError.
World make_box_world(const BallastBox& box, std::uint64_t seed);

/// Takes the rocks of all courses but the first out of a new world, where they would cost time, and
/// makes those of a course again, in their waiting places.
void remove_later_courses(World& world);
void add_course(World& world, std::size_t course, std::uint64_t seed);

/// How the materials of a box differ from those of the loaded ballast while the bed is made.
struct MakingMaterials {
    double softness = 1;         ///< factor on stiffness
    double most_restitution = 1; ///< upper limit of restitution
    double friction = 1;         ///< factor on friction
};
void set_materials(World& world, const MakingMaterials& making = {});

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
