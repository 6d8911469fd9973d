#pragma once

#include "components/clump.hpp"
#include "engine/archive.hpp"
#include "engine/run.hpp"
#include "engine/world.hpp"
#include "scenarios/rocks/grading.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

// A bed of rocks in a rectangular mould about the z axis, with its floor at z = 0, under a plate
// that a load presses down. It is made as the specimens of triaxial tests are: rocks grow in place
// without friction, are pressed with friction, and then friction is reduced until the core is as
// dense as wanted.

/// The rocks that a bed is made of.
struct BedRocks {
    std::string grading = "arema_4";   ///< see grading_named
    std::filesystem::path clumps = {}; ///< see clumps_of
    double scale = 1;                  ///< factor on all sizes
    double smallest = 0;               ///< m, sieve size of truncation before scaling; 0: none
};

/// Draws rocks with this solid volume (m3); sizes are scaled. Throws InputError.
RockSample sample_of_volume(const BedRocks& rocks, const std::vector<Clump>& clumps, double volume,
                            std::uint64_t seed);

/// How a bed is made.
struct RockBedSettings {
    Vec3 size = Vec3::Zero(); ///< m, inner sides of the mould; z: height at the wanted porosity
    double porosity = 0.38;   ///< of the core
    double tolerance = 0.005; ///< of the porosity
    double pressure = 50e3;   ///< Pa, of the plate, its weight included
    /// m, corners of the core; equal ones: the middle half of the height, 0.3 of a side around.
    Vec3 core_low = Vec3::Zero(), core_high = Vec3::Zero();
    std::uint64_t longest = 400'000; ///< steps of the pressing
    std::uint64_t seed = 1;
};

/// A bed in its world.
struct RockBed {
    static constexpr auto name = "rock_bed";
    RockBedSettings settings = {};
    std::vector<EntityId> rocks = {};
    EntityId plate = nobody;
    EntityId tie = nobody;                  ///< a block in the bed, if there is one
    Vec3 tie_size = Vec3::Zero();           ///< m
    double tie_area = 0;                    ///< m2, of the tie's lower side within the mould
    std::uint32_t rock = 0;                 ///< material
    double friction = 0.6, restitution = 1; ///< of the rocks in a test
    double solid_volume = 0;                ///< m3
    double mean_size = 0, largest_size = 0; ///< m, sieve sizes
    double lid = 0;                         ///< m, height of the mould in which rocks grow
    EntityId first_grain = nobody;          ///< of fines as particles; all bodies from it on
    double area() const { return settings.size.x() * settings.size.y(); }
    double plate_area() const { return area() - tie_area; } ///< m2, that presses on rocks
};

/// How far a bed is made; State.
struct RockBedState {
    static constexpr auto name = "rock_bed_state";
    static constexpr bool is_state = true;
    double steps = 0;    ///< of the phase
    double friction = 0; ///< at present
    double poured = 0;   ///< core porosity with the friction of the test; 0: not known yet
    double porosity = 1; ///< of the core, measured last
    double made = 0;     ///< 1: the bed is made
    void save(Archive& archive) const {
        put_fields(archive, "rock_bed", std::tie(steps, friction, poured, porosity, made));
    }
    void load(const Archive& archive) {
        get_fields(archive, "rock_bed", std::tie(steps, friction, poured, porosity, made));
    }
};

constexpr double plate_mass = 4, plate_thickness = 0.05; // kg, m

/// Adds rocks, parked below the floor, and a plate that is free along z only and reaches
/// `overhang` (m) beyond the mould, so that no rock passes it. Walls and floor are up to the
/// caller.
void add_rock_bed(World& world, const RockBedSettings& settings, const std::vector<Clump>& clumps,
                  const RockSample& sample, std::uint32_t rock, double overhang);

/// Makes a free block of facets in the mould (`size`: m; `volume`: m3, within the mould) the tie of
/// the bed: rocks grow around it while it is fixed, and it is pressed down with the pressure of the
/// plate, which passes it. The mould becomes higher by its volume. Guides are up to the caller.
void add_tie(World& world, EntityId tie, const Vec3& size, double volume);

/// Phases that make a bed: grow and press. Throw SimulationError where the porosity is out of
/// reach.
std::vector<Phase> make_bed_phases();

/// Sets the friction and the restitution between rocks.
void set_contacts(World& world, double friction, double restitution);
/// Masses for the largest stable step that keeps the total mass, and this step.
void rescale_masses(World& world, double safety);
/// Sets the force (N) with which the plate presses, its weight included.
void press_plate(World& world, double force);
/// Sets the pressure (Pa) with which the tie is pressed down besides its weight.
void press_tie(World& world, double pressure);
/// Changes the force of the plate linearly over `duration` (s).
void ramp_plate(World& world, double force, double duration);

/// Height (m) of the lower side of the plate.
double plate_height(const World& world);
/// Core porosity of the bed.
double bed_porosity(const World& world);

} // namespace bris
