#pragma once

#include "components/clump.hpp"
#include "engine/world.hpp"
#include "scenarios/rocks/grading.hpp"
#include "scenarios/specimens/sensor_rocks.hpp"

#include <vector>

namespace bris {

/// Everything a triaxial specimen is made of. The axis is z, the lower platen stands at z = 0.
struct SpecimenSettings {
    double radius = 0.1525; ///< m, of the circle inside the membrane's polygon
    double height = 0.61;   ///< m, wanted
    unsigned rings = 8, sectors = 12;
    bool per_element = false;        ///< servo of the membrane
    double density = 2750;           ///< kg/m3
    double friction = 0.7;           ///< rock on rock and rock on platen
    double clump_stiffness = 0.63e8; ///< N/m, normal and shear, of one partner
    double wall_stiffness = 1e8;     ///< N/m
    double looseness = 1.2;          ///< height of the lifts as they are made, of the wanted one
    double smartrock_size = 0.038;   ///< m, sieve size
    double sensor_density = 0;       ///< kg/m3, of the sensor rocks; 0: as the rocks
    double sensor_friction = -1;     ///< of their shells; below 0: as the rocks
    std::uint64_t seed = 1;
};

/// Which bodies are what.
struct Specimen {
    static constexpr auto name = "specimen";
    std::vector<EntityId> smart_rocks, rocks; ///< rocks in the order in which they are poured
    EntityId top = nobody, bottom = nobody;
    std::uint32_t rock_material = 0, platen_material = 0, membrane_material = 0;
    std::uint32_t sensor_material =
        0; ///< of the sensor rocks: that of the rocks, or of shells of their own
    double sensor_friction = -1; ///< below 0: they follow the rocks
    std::vector<SmartRockPose> smart_rock_poses;
    std::uint64_t seed = 1;
    double height = 0, looseness = 1;
    std::vector<Clump> clumps; ///< the library; a body's ShapeOf is its place here
    std::vector<double> scale; ///< of each body id, from the library's size to full size
};

/// Radius (m) of a specimen twice as high as wide that holds this volume of solids (m3) at the
/// given porosity, measured in the polygon.
double radius_for(double solid_volume, double porosity, unsigned sectors);

/// Makes the world of a triaxial test: materials, sensor rocks held at `looseness` times their
/// heights (they sink with the top platen to their given places while the specimen is compacted),
/// rocks parked below the lower platen, membrane and platens. Sensor rocks take the shapes
/// `smart_rocks` in turn.
World make_triaxial_world(const SpecimenSettings& settings, std::span<const Clump> clumps,
                          std::span<const Clump> smart_rocks, std::span<const RockChoice> rocks,
                          std::span<const SmartRockPose> poses);

} // namespace bris
