#include "systems/fields/field_set.hpp"

#include "components/kinds.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "systems/fields/bed_surface.hpp"
#include "systems/fields/coarse_grain.hpp"
#include "systems/fields/image_file.hpp"
#include "systems/fields/smooth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

/// Rocks reach into boundaries by their overlap; the voxels behind them are not shown.
constexpr double least_shown = 0.01;

/// A field whose values are value(number) where `shown` is not 0.
template <class Value>
VoxelField field_of(const VoxelBlocks& blocks, const VoxelField& shown, Value&& value) {
    VoxelField field(blocks);
    for (std::uint32_t n = 0; n < blocks.voxels(); ++n)
        if (shown[n] != 0) field[n] = value(n);
    return field;
}

double mean_radius(const World& world) {
    const auto mass = world.column<Bodies, Mass>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    double sum = 0, count = 0;
    for (const Row r : in_order_of_ids(world.column<Bodies, BodyId>()))
        if (mass[r] > 0) sum += radius[r], ++count;
    return count > 0 ? sum / count : 0;
}

/// The part of a scene's container that lies around the rocks; absent if nothing bounds it.
std::optional<Container> container_of(const World& world, const Box3& rocks) {
    Box3 heights = unbounded();
    heights.low.z() = rocks.low.z();
    heights.high.z() = rocks.high.z();
    Container container(world, heights,
                        world.has_resource<Fouling>() ? world.resource<Fouling>().blocked
                                                      : std::vector<Box3>());
    try {
        (void)container.bounds();
    } catch (const InputError&) {
        return std::nullopt;
    }
    return container;
}

Box3 around_rocks(const BodySpheres& bodies) {
    Box3 all{Vec3::Constant(std::numeric_limits<double>::infinity()),
             Vec3::Constant(-std::numeric_limits<double>::infinity())};
    for (std::size_t b = 0; b < bodies.bodies(); ++b) {
        if (!bodies.has_spheres(b)) continue;
        all.low = all.low.cwiseMin(bodies.box[b].low);
        all.high = all.high.cwiseMax(bodies.box[b].high);
    }
    require(all.low.x() < all.high.x(), "fields: expected rocks, found none");
    return all;
}

void add_motion_and_stress(FieldSet& set, const World& world, int half_width) {
    const CoarseFields c = coarse_grain(world, set.blocks, half_width);
    const auto ours = [&](const VoxelField& field) {
        return on_blocks(field, c.blocks, set.blocks);
    };
    set.fields.push_back({"velocity",
                          "m/s",
                          "Velocity of the rocks, averaged by mass.",
                          {ours(c.velocity[0]), ours(c.velocity[1]), ours(c.velocity[2])}});
    VoxelField shear(c.blocks), mean(c.blocks);
    for (std::uint32_t n = 0; n < c.blocks.voxels(); ++n) {
        const auto e = [&](std::size_t k) { return c.strain_rate[k][n]; };
        const double third = (e(0) + e(1) + e(2)) / 3;
        double sum = 0; // of the squares of the deviator
        for (std::size_t k = 0; k < 3; ++k)
            sum += (e(k) - third) * (e(k) - third) + 2 * e(k + 3) * e(k + 3);
        shear[n] = std::sqrt(2.0 / 3 * sum);
        if (c.has_stress) mean[n] = (c.stress[0][n] + c.stress[1][n] + c.stress[2][n]) / 3;
    }
    set.fields.push_back({"shear_strain_rate",
                          "1/s",
                          "Equivalent shear strain rate, sqrt(2/3 e : e) of the deviator.",
                          {ours(shear)}});
    set.has_stress = c.has_stress;
    if (!c.has_stress) return;
    set.fields.push_back(
        {"mean_stress", "Pa", "Mean stress of the contacts, compression positive.", {ours(mean)}});
    set.fields.push_back({"stress_zz",
                          "Pa",
                          "Vertical stress of the contacts, compression positive.",
                          {ours(c.stress[2])}});
}

void add_fouling(FieldSet& set, const World& world, const Fouling& f, int half_width) {
    const double volume = f.blocks.lattice().volume();
    const auto voids = [&](std::uint32_t n) { return volume * f.solid.voids()[n]; };
    const auto add = [&](const char* name, const char* units, const char* quantity, auto&& value) {
        set.fields.push_back({name, units, quantity, {field_of(set.blocks, set.shown, value)}});
    };
    add("fines", "kg/m3", "Mass of fines per volume.",
        [&](std::uint32_t n) { return f.fines[n] / volume; });
    // ratios of averages, because single voxels may have few voids
    const auto average = [&](auto&& value) {
        return smoothed(field_of(set.blocks, set.shown, value), set.blocks, half_width);
    };
    double rock_mass = 0;
    for (const double m : world.column<Bodies, Mass>()) rock_mass += m;
    const double rock_density = rock_mass / set.solids.value;
    const VoxelField fines = average([&](std::uint32_t n) { return f.fines[n]; }),
                     open = average(voids),
                     water = average([&](std::uint32_t n) { return f.water[n]; }),
                     ballast = average([&](std::uint32_t n) {
                         return rock_density * volume * f.solid.solid()[n];
                     });
    const auto measures = [&](std::uint32_t n) {
        FoulingMeasures m{.ballast_mass = ballast[n],
                          .fines_mass = fines[n],
                          .void_volume = open[n],
                          .water_volume = water[n]};
        complete(m, f.settings);
        return m;
    };
    add("fouling", "%", "Void contaminant index VCI.",
        [&](std::uint32_t n) { return measures(n).contaminant_index; });
    add("fouling_index", "%", "Fouling index of Selig and Waters, P4 + P200.",
        [&](std::uint32_t n) { return measures(n).fouling_index; });
    add("saturation", "%", "Water in the voids that the fines leave.",
        [&](std::uint32_t n) { return measures(n).saturation; });
}

/// Refuses voxels that memory cannot hold, or whose numbers would overflow.
void check_voxel(double voxel, const Box3& rocks) {
    constexpr double most = 1e9;
    const Vec3 size = rocks.high - rocks.low;
    require(voxel > 0 && std::isfinite(voxel) && (size / voxel).maxCoeff() < most &&
                (size / voxel).prod() <= most,
            fmt::format("voxel: expected at most {:g} in the box of the rocks, {:.3g} x {:.3g} x "
                        "{:.3g} m, found voxels of {:g} m",
                        most, size.x(), size.y(), size.z(), voxel));
}

} // namespace

FieldSet fields_of(const World& world, const FieldSetSettings& settings) {
    const BodySpheres bodies = spheres_of_bodies(world);
    const Box3 rocks = around_rocks(bodies);
    const auto container = container_of(world, rocks);
    std::optional<Fouling> fouling;
    if (has_fouling_fields(world)) fouling = present_fouling(world);
    const double voxel = fouling ? fouling->settings.voxel : settings.voxel;
    check_voxel(voxel, rocks);
    SolidFraction solid(Lattice{Vec3::Constant(0.5 * voxel), voxel},
                        static_cast<int>(settings.samples));
    Box3 covered = rocks;
    if (fouling)
        covered = fouling->region; // the same blocks
    else if (container)
        covered = container->bounds();
    solid.update(bodies, container ? &*container : nullptr, &covered);

    FieldSet set;
    set.blocks = solid.blocks();
    set.solids = solid.volume();
    set.averaging = settings.averaging > 0 ? settings.averaging : mean_radius(world);
    const int half_width = std::max(1, static_cast<int>(std::lround(set.averaging / voxel)));
    const auto voids = [&](std::uint32_t n) { return container ? solid.voids()[n] : 0.0; };
    set.shown = VoxelField(set.blocks);
    for (std::uint32_t n = 0; n < set.blocks.voxels(); ++n)
        set.shown[n] = solid.solid()[n] + voids(n) > least_shown ? 1 : 0;
    const int a_rock = std::max(1, static_cast<int>(std::lround(2 * mean_radius(world) / voxel)));
    hide_air_above(set.shown, solid.solid(), set.blocks, a_rock);
    if (container)
        set.void_volume =
            set.blocks.lattice().volume() *
            field_of(set.blocks, set.shown, [&](std::uint32_t n) { return voids(n); }).sum();
    set.fields.push_back(
        {"density", "1", "Fraction of the volume that rocks fill.", {solid.solid()}});
    set.fields.push_back({"density_error", "1", "Estimated error of density.", {solid.error()}});
    set.fields.push_back({"porosity",
                          "1",
                          "Fraction of the volume that rocks leave.",
                          {field_of(set.blocks, set.shown, [&](std::uint32_t n) {
                              const double filled = solid.solid()[n];
                              return container ? voids(n) / (voids(n) + filled) : 1 - filled;
                          })}});
    add_motion_and_stress(set, world, half_width);
    if (fouling) add_fouling(set, world, *fouling, half_width);
    return set;
}

const FieldSet::Field* FieldSet::find(const std::string& name) const {
    const auto found = std::ranges::find(fields, name, &Field::name);
    return found == fields.end() ? nullptr : &*found;
}

std::vector<FieldToWrite> FieldSet::to_write() const {
    std::vector<FieldToWrite> list;
    for (const Field& field : fields) {
        list.push_back({field.name, field.units, field.quantity, {}, &shown});
        for (const VoxelField& component : field.components)
            list.back().components.push_back(&component);
    }
    return list;
}

void write_fields(const FieldSet& set, const std::filesystem::path& folder, const std::string& name,
                  double time, const std::vector<NamedValue>& meta) {
    require(!shown_range(set.blocks, set.shown).empty(),
            fmt::format("fields: expected voxels of which rocks fill {:g} or more, found none: are "
                        "voxels of {:g} m larger than the scene?",
                        least_shown, set.blocks.lattice().size));
    write_vdb(folder / (name + ".vdb"), set.blocks, set.to_write(), time, meta);
    write_image(folder / (name + ".vtkhdf"), set.blocks, set.to_write(), time, meta);
}

} // namespace bris
