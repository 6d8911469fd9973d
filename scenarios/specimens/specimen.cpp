#include "scenarios/specimens/specimen.hpp"

#include "components/kinds.hpp"
#include "components/platen.hpp"
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/sleeve.hpp"

namespace bris {

namespace {

constexpr std::uint64_t orientation_stream = 1002;

void add_platens(World& world, const SpecimenSettings& s, Specimen& specimen) {
    specimen.bottom =
        add_boundary(world, Vec3::Zero(), specimen.platen_material, Motion::fixed, s.radius);
    specimen.top = add_boundary(world, Vec3(0, 0, 1.5 * s.height), specimen.platen_material,
                                Motion::servo, s.radius);
    add_plane(world, specimen.bottom, Vec3::Zero(), Vec3(0, 0, 1));
    Platen platen;
    platen.plane = add_plane(world, specimen.top, Vec3::Zero(), Vec3(0, 0, -1));
    world.add_resource(platen);
}

/// Triangles with edges of about the wanted length.
SleeveMesh mesh_of(const SpecimenSettings& s) {
    const double edge = s.latex.edge * s.smartrock_size,
                 side = 2 * s.radius * std::tan(pi / s.sectors);
    const auto parts = [&](double length) {
        return static_cast<unsigned>(std::max(1.0, std::round(length / edge)));
    };
    return {s.sectors * parts(side), 1 + parts(s.height), s.sectors, s.radius, s.height};
}

/// Material of the sensor rocks: a separate one only if it differs from that of the rocks.
std::uint32_t add_shell(Materials& materials, const SpecimenSettings& s, std::uint32_t rock) {
    if (s.sensor_density <= 0 && s.sensor_friction < 0) return rock;
    Material shell = materials.list[rock];
    shell.name = "shell";
    if (s.sensor_density > 0) shell.density = s.sensor_density;
    if (s.sensor_friction >= 0) shell.friction = s.sensor_friction;
    return materials.add(shell);
}

} // namespace

const std::vector<std::string>& texts_of(MembraneKind) {
    static const std::vector<std::string> texts{"rings", "latex"};
    return texts;
}

void give_constants_of_law(World& world, const SpecimenSettings& s) {
    auto& materials = world.resource<Materials>();
    const auto& specimen = world.resource<Specimen>();
    if (is_hertz(s.law))
        for (Material& m : materials.list) {
            m.young_modulus = s.young_modulus;
            m.poisson_ratio = s.poisson_ratio;
        }
    if (traits(s.law).edges)
        for (const auto rock : {specimen.rock_material, specimen.sensor_material})
            s.edges.give_to(materials.list[rock]);
    if (s.membrane == MembraneKind::latex) {
        Material& latex = materials.list[specimen.membrane_material];
        latex.normal_stiffness = latex.shear_stiffness = s.latex.contact_stiffness;
    }
    materials.mix();
}

void put_on_latex(World& world, const SpecimenSettings& s) {
    world.resource<Membrane>().pressure.clear(); // of rings
    world.resource<Membrane>().stiffness.clear();
    auto& sleeve = world.resource<Sleeve>();
    sleeve.thickness = s.latex.thickness;
    sleeve.young_modulus = s.latex.young_modulus;
    sleeve.wrinkles = s.latex.wrinkles;
    const auto& specimen = world.resource<Specimen>();
    put_on(world, s.sectors, s.radius,
           world.column<Bodies, Position>()[row_of_body(world, specimen.top)].z());
}

double radius_for(double solid_volume, double porosity, unsigned sectors) {
    // polygon area n tan(pi/n) R^2, height 4 R
    const double shape = 4 * sectors * std::tan(pi / sectors);
    return std::cbrt(solid_volume / (1 - porosity) / shape);
}

World make_triaxial_world(const SpecimenSettings& s, std::span<const Clump> clumps,
                          std::span<const Clump> smart_rocks, std::span<const RockChoice> rocks,
                          std::span<const SmartRockPose> poses) {
    World world = make_world(Grains::clumps);
    auto& materials = world.resource<Materials>();
    Specimen specimen;
    specimen.rock_material =
        materials.add({"rock", s.density, s.clump_stiffness, s.clump_stiffness, s.friction});
    specimen.platen_material =
        materials.add({"platen", 0, s.wall_stiffness, s.wall_stiffness,
                       s.platen_friction < 0 ? s.friction : s.platen_friction});
    specimen.membrane_material =
        materials.add({"membrane", 0, s.wall_stiffness, s.wall_stiffness, 0});
    specimen.sensor_material = add_shell(materials, s, specimen.rock_material);
    specimen.sensor_friction = s.sensor_friction;
    specimen.platen_friction = s.platen_friction;
    specimen.smart_rock_poses.assign(poses.begin(), poses.end());
    specimen.seed = s.seed;
    specimen.clumps.assign(clumps.begin(), clumps.end());
    specimen.clumps.insert(specimen.clumps.end(), smart_rocks.begin(), smart_rocks.end());
    specimen.height = s.height;
    specimen.looseness = s.looseness;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const std::size_t shape = i % smart_rocks.size();
        specimen.smart_rocks.push_back(
            add_clump(world, smart_rocks[shape], static_cast<std::uint32_t>(clumps.size() + shape),
                      poses[i].position.cwiseProduct(Vec3(1, 1, s.looseness)), poses[i].orientation,
                      specimen.sensor_material, Motion::prescribed));
    }
    specimen.scale.assign(poses.size(), 1.0);
    Random random(s.seed, orientation_stream);
    for (const RockChoice& choice : rocks) {
        specimen.scale.push_back(choice.sieve / clumps[choice.clump].sieve);
        const Clump clump = scaled(clumps[choice.clump], specimen.scale.back());
        // parked on a lattice below the lower platen, which no free body reaches
        const std::size_t i = specimen.rocks.size();
        const Vec3 position(static_cast<double>(i % 16), static_cast<double>(i / 16 % 16),
                            -1 - static_cast<double>(i / 256));
        specimen.rocks.push_back(add_clump(world, clump, static_cast<std::uint32_t>(choice.clump),
                                           s.height * position, random.rotation(),
                                           specimen.rock_material, Motion::fixed));
    }
    Membrane membrane;
    membrane.active = false;
    membrane.per_element = s.per_element;
    membrane.rings = s.rings;
    membrane.sectors = s.sectors;
    membrane.ring_height = s.height / s.rings;
    if (s.membrane == MembraneKind::latex)
        add_sleeve(world, std::move(membrane), {}, mesh_of(s), specimen.membrane_material);
    else
        add_membrane(world, std::move(membrane), s.radius, specimen.membrane_material);
    add_platens(world, s, specimen);
    world.resource<Limits>().low = Vec3(-2 * s.radius, -2 * s.radius, -0.1 * s.height);
    world.resource<Limits>().high = Vec3(2 * s.radius, 2 * s.radius, 2 * s.height);
    world.table<Bodies>().add<Growth>();
    world.add_resource(LocalDamping{0.7});
    world.add_resource(Gravity{});
    world.add_resource(std::move(specimen));
    give_constants_of_law(world, s);
    return world;
}

} // namespace bris
