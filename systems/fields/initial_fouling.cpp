#include "systems/fields/initial_fouling.hpp"

#include "components/kinds.hpp"
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "systems/fields/capacity.hpp"
#include "systems/fields/displace.hpp"
#include "systems/fields/vdb_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace bris {

namespace {

/// Lowest and highest point of the rocks in the space of the fields (m), and their mass (kg).
struct Ballast {
    double low = std::numeric_limits<double>::infinity(), high = -low, mass = 0;
    Box3 box{Vec3::Constant(low), Vec3::Constant(high)};
};

Ballast ballast_of(const World& world) {
    const Box3& space = world.resource<Fouling>().region;
    const BodySpheres bodies = spheres_of_bodies(world);
    Ballast all;
    for (std::size_t b = 0; b < bodies.bodies(); ++b) {
        const Vec3& x = bodies.pose[b].position;
        if (!bodies.has_spheres(b) || (x.array() < space.low.array()).any() ||
            (x.array() > space.high.array()).any())
            continue;
        all.box.low = all.box.low.cwiseMin(bodies.box[b].low);
        all.box.high = all.box.high.cwiseMax(bodies.box[b].high);
        all.mass += world.column<Bodies, Mass>()[bodies.row[b]];
    }
    all.low = all.box.low.z();
    all.high = all.box.high.z();
    return all;
}

/// The same random number for a cube of four voxels.
double random_factor(const Voxel& v, std::uint64_t seed) {
    const auto part = [](int x) { return static_cast<std::uint64_t>((x >> 2) + (1 << 20)); };
    return Random(seed, part(v.x) << 42 | part(v.y) << 21 | part(v.z)).uniform(0, 2);
}

/// Share of the height of a voxel that lies between two heights.
double share_between(double centre, double size, double low, double high) {
    return std::clamp((std::min(centre + 0.5 * size, high) - std::max(centre - 0.5 * size, low)) /
                          size,
                      0.0, 1.0);
}

/// Weights by which the fines are divided among the voxels.
VoxelField weights_of(const Fouling& f, const InitialFouling& initial, const Ballast& ballast) {
    const bool layered = initial.pattern == InitialFouling::Pattern::layered;
    const double height = ballast.high - ballast.low,
                 low = ballast.low + (layered ? initial.low * height : 0),
                 high = layered ? ballast.low + initial.high * height : ballast.high;
    VoxelField weight(f.blocks);
    for (std::uint32_t n = 0; n < f.blocks.voxels(); ++n) {
        const Voxel v = f.blocks.voxel(n);
        weight[n] = f.solid.voids()[n] * share_between(f.blocks.lattice().centre(v).z(),
                                                       f.blocks.lattice().size, low, high);
        if (initial.pattern == InitialFouling::Pattern::random)
            weight[n] *= random_factor(v, initial.seed);
    }
    return weight;
}

/// Divides `total` by weight, but gives no voxel more than its capacity: amount = min(capacity,
/// scale * weight), with the scale found by bisection. Multiples of `unit`, which add up to total.
VoxelField divided(double total, const VoxelField& weight, const VoxelField& capacity,
                   const VoxelBlocks& blocks, double unit) {
    const auto amount = [&](std::uint32_t n, double scale) {
        return floor_to(unit, std::min(capacity[n], scale * weight[n]));
    };
    const auto sum = [&](double scale) {
        double all = 0;
        for (std::uint32_t n = 0; n < blocks.voxels(); ++n) all += amount(n, scale);
        return all;
    };
    double low = 0, high = 2 * total / weight.sum();
    while (sum(high) < total && high < 1e6 * total / weight.sum()) high *= 2;
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        (sum(middle) <= total ? low : high) = middle;
    }
    VoxelField field(blocks);
    double left = total;
    for (std::uint32_t n = 0; n < blocks.voxels(); ++n) left -= field[n] = amount(n, low);
    for (std::uint32_t n = 0; n < blocks.voxels() && left > 0; ++n) { // what rounding has left
        if (!(weight[n] > 0)) continue;
        const double given = std::min(left, floor_to(unit, capacity[n]) - field[n]);
        field[n] += given;
        left -= given;
    }
    return field;
}

void fill_by_mass(Fouling& f, const InitialFouling& initial, const Ballast& ballast) {
    const VoxelField weight = weights_of(f, initial, ballast), capacity = fines_capacity(f);
    double most = 0;
    for (std::uint32_t n = 0; n < f.blocks.voxels(); ++n)
        if (weight[n] > 0) most += capacity[n];
    double total = ballast.mass * initial.p4 / (100 - initial.p4);
    require(total < most,
            fmt::format("fouling: expected P4 below {:.3g} %, with which compacted fines fill the "
                        "voids, found {:g} %",
                        100 * most / (most + ballast.mass), initial.p4));
    f.fines_unit = exact_unit(total);
    total = floor_to(f.fines_unit, total);
    f.fines = divided(total, weight, capacity, f.blocks, f.fines_unit);
    f.settings.silt = initial.p200 / initial.p4;
}

/// A grid of fields whose values at the centres of our voxels are asked for.
double value_at(const VdbField& from, const Vec3& x) {
    const std::uint32_t n = from.blocks.number(from.blocks.lattice().voxel_of(x));
    return n == VoxelBlocks::none ? 0 : from.values[n];
}

void fill_from_file(Fouling& f, const InitialFouling& initial, const Ballast& ballast) {
    const std::string file = initial.file.string();
    const VdbField mass = read_vdb(initial.file, "fines");
    const Box3 covered = mass.box();
    require((covered.low.array() <= ballast.box.low.array()).all() &&
                (covered.high.array() >= ballast.box.high.array()).all(),
            fmt::format("{}: grid fines: expected voxels that cover the rocks, ({:.3g}, {:.3g}, "
                        "{:.3g}) to ({:.3g}, {:.3g}, {:.3g}) m, found ({:.3g}, {:.3g}, {:.3g}) to "
                        "({:.3g}, {:.3g}, {:.3g}) m",
                        file, ballast.box.low.x(), ballast.box.low.y(), ballast.box.low.z(),
                        ballast.box.high.x(), ballast.box.high.y(), ballast.box.high.z(),
                        covered.low.x(), covered.low.y(), covered.low.z(), covered.high.x(),
                        covered.high.y(), covered.high.z()));
    const Lattice& lattice = f.blocks.lattice();
    double total = 0;
    for (std::uint32_t n = 0; n < f.blocks.voxels(); ++n) {
        const Vec3 x = lattice.centre(f.blocks.voxel(n));
        const double value = value_at(mass, x);
        require(
            value >= 0 && std::isfinite(value),
            fmt::format("{}: grid fines: expected kg/m3 of 0 or more, found {:g}", file, value));
        // mass of the part of the voxel inside the container and between the ends of the ballast
        f.fines[n] = value * lattice.volume() *
                     std::min(1.0, f.solid.solid()[n] + f.solid.voids()[n]) *
                     share_between(x.z(), lattice.size, ballast.low, ballast.high);
        total += f.fines[n];
    }
    if (total > 0) f.fines_unit = exact_unit(total);
    for (std::uint32_t n = 0; total > 0 && n < f.blocks.voxels(); ++n)
        f.fines[n] = floor_to(f.fines_unit, f.fines[n]);
    const double beyond =
        total > 0 ? displace_excess(f.fines, f.blocks, fines_capacity(f), f.fines_unit) : 0;
    require(beyond == 0,
            fmt::format("{}: grid fines: expected no more than the voids can hold, found {:.3g} kg "
                        "too many of {:.3g} kg",
                        file, beyond, total));
}

void fill_with_water(Fouling& f, const InitialFouling& initial, const Ballast& ballast) {
    const bool from_file = initial.pattern == InitialFouling::Pattern::file;
    std::optional<VdbField> given;
    if (from_file) given = find_vdb(initial.file, "saturation");
    const Lattice& lattice = f.blocks.lattice();
    const double all = lattice.volume() * f.solid.voids().sum();
    if (!(all > 0) || (!given && initial.saturation == 0)) return;
    f.water_unit = exact_unit(all);
    for (std::uint32_t n = 0; n < f.blocks.voxels(); ++n) {
        const Vec3 x = lattice.centre(f.blocks.voxel(n));
        const double s = given ? value_at(*given, x) : initial.saturation;
        require(s >= 0 && s <= 1,
                fmt::format("{}: grid saturation: expected values from 0 to 1, found {:g}",
                            initial.file.string(), s));
        const double voids = lattice.volume() * f.solid.voids()[n] *
                             share_between(x.z(), lattice.size, ballast.low, ballast.high);
        f.water[n] =
            floor_to(f.water_unit, s * std::max(voids - f.fines[n] / f.settings.density, 0.0));
    }
}

void check(const InitialFouling& i) {
    const auto expect = [](bool holds, const char* what, double found) {
        require(holds, fmt::format("fouling: expected {}, found {:g}", what, found));
    };
    expect(i.p4 >= 0 && i.p4 < 100, "P4 from 0 to below 100 %", i.p4);
    expect(i.p200 >= 0 && i.p200 <= i.p4, "P200 from 0 to P4, in %", i.p200);
    expect(i.saturation >= 0 && i.saturation <= 1, "a saturation from 0 to 1", i.saturation);
    expect(i.low >= 0 && i.low < i.high && i.high <= 1,
           "the lower end of the layer from 0 to below its upper end, which is at most 1", i.low);
}

} // namespace

void fill_with_fines(World& world, const InitialFouling& initial) {
    check(initial);
    prepare_voids(world);
    Fouling f = world.resource<Fouling>(); // replaced only when all is well
    const Ballast ballast = ballast_of(world);
    require(ballast.mass > 0, "fouling: expected rocks with a mass, found none");
    if (initial.pattern == InitialFouling::Pattern::file)
        fill_from_file(f, initial, ballast);
    else if (initial.p4 > 0)
        fill_by_mass(f, initial, ballast);
    fill_with_water(f, initial, ballast);
    f.stale = true;
    world.resource<Fouling>() = std::move(f);
}

} // namespace bris
