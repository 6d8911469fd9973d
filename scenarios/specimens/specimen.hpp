#pragma once

#include "components/clump.hpp"
#include "components/material.hpp"
#include "engine/world.hpp"
#include "scenarios/rocks/grading.hpp"
#include "scenarios/specimens/rock_edges.hpp"
#include "scenarios/specimens/sensor_rocks.hpp"

#include <string>
#include <vector>

namespace bris {

/// What holds a triaxial specimen while it is tested.
enum class MembraneKind { rings, latex };
const std::vector<std::string>& texts_of(MembraneKind);

/// A sleeve of latex around a specimen.
struct LatexSettings {
    double thickness = 2e-3;        ///< m
    double young_modulus = 1.4e6;   ///< Pa
    bool wrinkles = true;           ///< takes no compression
    double edge = 0.5;              ///< of its triangles, over the size of the sensor rocks
    double contact_stiffness = 2e6; ///< N/m, of one partner
    friend bool operator==(const LatexSettings&, const LatexSettings&) = default;
};

/// Settings of a triaxial specimen. Its axis is z; the lower platen is at z = 0.
struct SpecimenSettings {
    double radius = 0.1525;           ///< m, of the circle inscribed in the polygon of the membrane
    double height = 0.61;             ///< m, wanted
    unsigned rings = 8, sectors = 12; ///< of the membrane
    bool per_element = false;         ///< servo of each membrane element instead of each ring
    MembraneKind membrane = MembraneKind::rings;
    LatexSettings latex = {};
    double density = 2750;           ///< kg/m3
    double friction = 0.7;           ///< Coulomb coefficient, rock on rock and rock on platen
    double clump_stiffness = 0.63e8; ///< N/m, normal and shear, of one partner
    double wall_stiffness = 1e8;     ///< N/m
    /// Contact law of the test. Hertz laws take the elastic constants of all partners. The specimen
    /// is prepared with linear contacts all the same, and the stiffnesses above give the masses of
    /// servos and the least masses of rocks.
    LawName law = LawName::linear;
    RockEdges edges = {};
    double young_modulus = 7e10, poisson_ratio = 0.2; ///< Pa, -
    double looseness = 1.3;        ///< height of the mould when filled, relative to the wanted one
    double smartrock_size = 0.038; ///< m, sieve size
    double sensor_density = 0;     ///< kg/m3, of the sensor rocks; 0: as the rocks
    double sensor_friction = -1;   ///< of the shells of the sensor rocks; below 0: as the rocks
    double platen_friction = -1;   ///< of the platens; below 0: as the rocks
    std::uint64_t seed = 1;
};

/// Bodies, materials and shapes of a triaxial specimen.
struct Specimen {
    static constexpr auto name = "specimen";
    std::vector<EntityId> smart_rocks, rocks; ///< rocks in the order in which they are poured
    EntityId top = nobody, bottom = nobody;   ///< platens
    std::uint32_t rock_material = 0, platen_material = 0, membrane_material = 0;
    /// Material of the sensor rocks: that of the rocks, or a separate one of their shells.
    std::uint32_t sensor_material = 0;
    double sensor_friction = -1, platen_friction = -1; ///< below 0: that of the rocks
    std::vector<SmartRockPose> smart_rock_poses;
    std::uint64_t seed = 1;
    double height = 0, looseness = 1;
    std::vector<Clump> clumps; ///< the library; ShapeOf of a body is its index here
    std::vector<double> scale; ///< by body id, from the size in the library to full size
};

/// Gives the materials of a specimen the constants that the law of the test reads and linear
/// contacts do not: of Hertz contacts, and the edges of rocks and sensor rocks; and a sleeve the
/// stiffness of its contacts.
void give_constants_of_law(World& world, const SpecimenSettings& settings);

/// Puts the sleeve of the test on a specimen that was prepared within rigid elements.
void put_on_latex(World& world, const SpecimenSettings& settings);

/// Radius (m) of a specimen with height twice the diameter that contains this solid volume (m3) at
/// the given porosity; the cross-section is the polygon of the membrane.
double radius_for(double solid_volume, double porosity, unsigned sectors);

/// Makes the world of a triaxial test: materials, sensor rocks, rocks, membrane and platens. The
/// sensor rocks are held at `looseness` times their heights and sink with the top platen to their
/// given positions while the specimen is compacted. They take the shapes `smart_rocks` in turn. The
/// rocks are parked below the lower platen.
World make_triaxial_world(const SpecimenSettings& settings, std::span<const Clump> clumps,
                          std::span<const Clump> smart_rocks, std::span<const RockChoice> rocks,
                          std::span<const SmartRockPose> poses);

} // namespace bris
