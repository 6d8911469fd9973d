#include "systems/fields/fouling.hpp"

#include "components/kinds.hpp"
#include "engine/errors.hpp"
#include "engine/parallel.hpp"
#include "systems/fields/capacity.hpp"
#include "systems/fields/displace.hpp"
#include "systems/fields/migration.hpp"
#include "systems/fields/weaken_contacts.hpp"

#include <fmt/format.h>

#include <limits>

namespace bris {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

auto corners(auto& box) {
    return std::tie(box.low.x(), box.low.y(), box.low.z(), box.high.x(), box.high.y(),
                    box.high.z());
}

auto numbers(auto& f) {
    return std::tie(f.fines_unit, f.water_unit, f.fines_beyond, f.water_beyond, f.drained,
                    f.updated_at, f.stale, f.is_fixed);
}

Box3 around(const Box3& a, const Box3& b) {
    return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

/// The lattice of a scene: corners of voxels lie at multiples of their size.
Lattice lattice_of(const FoulingSettings& s) { return {Vec3::Constant(0.5 * s.voxel), s.voxel}; }

void set_blocks(Fouling& f, const VoxelBlocks& blocks) {
    if (f.fines.blocks() > 0 && blocks == f.blocks) return;
    f.fines = on_blocks(f.fines, f.blocks, blocks);
    f.water = on_blocks(f.water, f.blocks, blocks);
    f.blocks = blocks;
}

/// Brings solids and voids up to date, and the fields onto their blocks.
void measure_voids(const World& world, Fouling& f, const BodySpheres& bodies) {
    const Container container(world, f.box, f.blocked);
    f.region = around(f.region, container.bounds());
    f.solid.update(bodies, &container, &f.region);
    set_blocks(f, f.solid.blocks());
}

/// VCI and saturation of the voids within a voxel of a body's bounding sphere.
LocalFouling fouling_around(const Fouling& f, const Vec3& centre, double radius) {
    const double reach = radius + f.settings.voxel, volume = f.blocks.lattice().volume();
    const Lattice& lattice = f.blocks.lattice();
    const Voxel low = lattice.voxel_of(centre - Vec3::Constant(reach)),
                high = lattice.voxel_of(centre + Vec3::Constant(reach));
    double fines = 0, water = 0, voids = 0;
    for (int i = low.x; i <= high.x; ++i)
        for (int j = low.y; j <= high.y; ++j)
            for (int k = low.z; k <= high.z; ++k) {
                const std::uint32_t n = f.blocks.number({i, j, k});
                if (n == VoxelBlocks::none ||
                    (lattice.centre({i, j, k}) - centre).squaredNorm() > reach * reach)
                    continue;
                fines += f.fines[n];
                water += f.water[n];
                voids += f.solid.voids()[n];
            }
    voids *= volume;
    if (!(voids > 0)) return {};
    const double solids = fines / f.settings.density, left = voids - solids;
    return {(1 + f.settings.void_ratio) * solids / voids,
            left > 0 ? std::min(water / left, 1.0) : 1.0};
}

void sample_bodies(World& world, const Fouling& f, const BodySpheres& bodies) {
    const auto radius = world.column<Bodies, BoundingRadius>();
    const auto around = world.column<Bodies, FoulingAround>();
    const auto pose = world.column<Bodies, SampledPose>();
    for_chunks(bodies.bodies(), 16, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b) {
            const Row r = bodies.row[b];
            pose[r] = bodies.pose[b];
            around[r] = bodies.has_spheres(b) ? fouling_around(f, pose[r].position, radius[r])
                                              : LocalFouling{};
        }
    });
}

void check(const FoulingSettings& s) {
    const auto expect = [](bool holds, const char* what, double found) {
        require(holds, fmt::format("fouling: expected {}, found {:g}", what, found));
    };
    expect(s.density > 0, "a density of the fines above 0 kg/m3", s.density);
    expect(s.void_ratio > 0, "a void ratio above 0", s.void_ratio);
    expect(s.least_void_ratio > 0 && s.least_void_ratio <= s.void_ratio,
           "a least void ratio above 0 and at most the void ratio", s.least_void_ratio);
    expect(s.silt >= 0 && s.silt <= 1, "a share of silt from 0 to 1", s.silt);
    expect(s.size > 0, "a size of the fines above 0 m", s.size);
    expect(s.voxel > 0, "voxels above 0 m", s.voxel);
    expect(s.samples >= 2 && s.samples <= 64, "2 to 64 lines across a voxel", s.samples);
    expect(s.refresh > 0, "a displacement above 0 voxels before an update", s.refresh);
    expect(s.check_every > 0, "1 step or more between checks", s.check_every);
}

/// Throws InputError if a rock lies outside the space of the fields and does not wait there.
void require_covered(const World& world, const BodySpheres& bodies, const Box3& bounds) {
    const auto motion = world.column<Bodies, MotionOf>();
    for (std::size_t b = 0; b < bodies.bodies(); ++b) {
        const bool waits = motion[bodies.row[b]] == static_cast<std::uint32_t>(Motion::fixed);
        if (!bodies.has_spheres(b) || waits) continue;
        const Vec3& x = bodies.pose[b].position;
        require((x.array() >= bounds.low.array()).all() && (x.array() <= bounds.high.array()).all(),
                fmt::format("fields: expected a space that covers all rocks, found body {} at "
                            "({:.4g}, {:.4g}, {:.4g}) m outside ({:.4g}, {:.4g}, {:.4g}) to "
                            "({:.4g}, {:.4g}, {:.4g}) m",
                            world.column<Bodies, BodyId>()[bodies.row[b]], x.x(), x.y(), x.z(),
                            bounds.low.x(), bounds.low.y(), bounds.low.z(), bounds.high.x(),
                            bounds.high.y(), bounds.high.z()));
    }
}

} // namespace

Box3 unbounded() { return {Vec3::Constant(-infinity), Vec3::Constant(infinity)}; }

void add_fouling(World& world, const FoulingSettings& settings, const FoulingLaw& law,
                 const Box3& box) {
    check(settings);
    Fouling f;
    f.settings = settings;
    f.box = box;
    f.region = {Vec3::Constant(infinity), Vec3::Constant(-infinity)}; // empty
    f.solid = SolidFraction(lattice_of(settings), static_cast<int>(settings.samples));
    f.updated_at = world.resource<Clock>().time();
    Table& bodies = world.table<Bodies>();
    bodies.add<FoulingAround>();
    bodies.add<SampledPose>();
    world.add_resource(law);
    world.add_resource(Weakening{});
    world.add_resource(std::move(f));
}

void prepare_voids(World& world) {
    auto& f = world.resource<Fouling>();
    const BodySpheres bodies = spheres_of_bodies(world);
    require_covered(world, bodies, Container(world, f.box).bounds());
    measure_voids(world, f, bodies);
}

bool fouling_is_due(const World& world) {
    if (!world.has_resource<Fouling>()) return false;
    const auto& f = world.resource<Fouling>();
    if (!f.is_checked(world.resource<Clock>().step)) return false;
    if (f.stale || f.settings.moves()) return true;
    const Table& bodies = world.table<Bodies>();
    const auto position = bodies.column<Position>();
    const auto radius = bodies.column<BoundingRadius>();
    const auto mass = bodies.column<Mass>();
    const auto sampled = bodies.column<SampledPose>();
    const double farthest = f.settings.refresh * f.settings.voxel;
    const Quat* orientation =
        bodies.has<Orientation>() ? bodies.column<Orientation>().data() : nullptr;
    for (Row b = 0; b < mass.size(); ++b) {
        if (!(mass[b] > 0)) continue; // boundaries do not fill voids
        const Quat q = orientation != nullptr ? orientation[b] : Quat(Quat::Identity());
        if (!(displacement_bound(position[b], q, sampled[b], radius[b]) <= farthest)) return true;
    }
    return false;
}

void update_fouling(World& world, Fouling& f) {
    const Clock& clock = world.resource<Clock>();
    const BodySpheres bodies = spheres_of_bodies(world);
    measure_voids(world, f, bodies);
    if (f.fines_unit > 0)
        f.fines_beyond = displace_excess(f.fines, f.blocks, fines_capacity(f), f.fines_unit);
    if (f.water_unit > 0)
        f.water_beyond = displace_excess(f.water, f.blocks, water_capacity(f), f.water_unit);
    if (f.settings.moves()) move_fines_and_water(f, clock.time() - f.updated_at);
    sample_bodies(world, f, bodies);
    f.updated_at = clock.time();
    f.stale = false;
    ++f.revision;
    ++f.updates;
}

void fix_fouling(World& world) {
    auto& f = world.resource<Fouling>();
    require(!f.settings.moves(),
            "fouling: expected fines and water that stay where they are, found ones that move");
    f.blocks = {};
    f.fines = f.water = {};
    f.solid = {};
    f.blocked.clear();
    f.is_fixed = true;
}

bool has_fouling_fields(const World& world) {
    return world.has_resource<Fouling>() && !world.resource<Fouling>().is_fixed;
}

Fouling present_fouling(const World& world) {
    require(has_fouling_fields(world),
            "fields: expected fields of fines, found bodies that keep the fouling around them");
    Fouling copy = world.resource<Fouling>();
    measure_voids(world, copy, spheres_of_bodies(world));
    return copy;
}

void Fouling::save(Archive& archive) const {
    put_fields(archive, "fields/settings", FoulingSettings::fields(settings));
    put_fields(archive, "fields/box", corners(box));
    put_fields(archive, "fields/region", corners(region));
    std::vector<double> boxes;
    for (const Box3& b : blocked)
        for (const Vec3* v : {&b.low, &b.high}) boxes.insert(boxes.end(), v->begin(), v->end());
    if (!boxes.empty()) archive.put("fields/blocked", std::span<const double>(boxes));
    put_fields(archive, "fields/numbers", numbers(*this));
    std::vector<std::int64_t> first;
    std::vector<double> mass, volume;
    for (std::size_t b = 0; b < blocks.count(); ++b) {
        const double *m = fines.block(b), *v = water.block(b);
        constexpr auto n = static_cast<std::size_t>(VoxelBlocks::voxels_each);
        if (std::all_of(m, m + n, [](double x) { return x == 0; }) &&
            std::all_of(v, v + n, [](double x) { return x == 0; }))
            continue;
        const Voxel& at = blocks.first()[b];
        first.insert(first.end(), {at.x, at.y, at.z});
        mass.insert(mass.end(), m, m + n);
        volume.insert(volume.end(), v, v + n);
    }
    archive.put("fields/blocks", std::span<const std::int64_t>(first));
    archive.put("fields/fines", std::span<const double>(mass));
    archive.put("fields/water", std::span<const double>(volume));
}

void Fouling::load(const Archive& archive) {
    get_fields(archive, "fields/settings", FoulingSettings::fields(settings));
    get_fields(archive, "fields/box", corners(box));
    get_fields(archive, "fields/region", corners(region));
    blocked.clear();
    std::vector<double> boxes;
    if (archive.find("fields/blocked") != nullptr) boxes = archive.get<double>("fields/blocked");
    for (std::size_t k = 0; k + 6 <= boxes.size(); k += 6)
        blocked.push_back({Vec3(boxes[k], boxes[k + 1], boxes[k + 2]),
                           Vec3(boxes[k + 3], boxes[k + 4], boxes[k + 5])});
    get_fields(archive, "fields/numbers", numbers(*this));
    const auto first = archive.get<std::int64_t>("fields/blocks");
    const auto mass = archive.get<double>("fields/fines"),
               volume = archive.get<double>("fields/water");
    require(first.size() % 3 == 0 && mass.size() == first.size() / 3 * VoxelBlocks::voxels_each &&
                volume.size() == mass.size(),
            "checkpoint: 'fields/fines': expected 512 values for each block, found another number");
    std::vector<Voxel> at;
    for (std::size_t k = 0; k < first.size(); k += 3)
        at.push_back({static_cast<int>(first[k]), static_cast<int>(first[k + 1]),
                      static_cast<int>(first[k + 2])});
    blocks = VoxelBlocks(lattice_of(settings), std::move(at));
    fines = VoxelField(blocks);
    water = VoxelField(blocks);
    for (std::size_t b = 0; b < blocks.count(); ++b) {
        std::copy_n(&mass[b * VoxelBlocks::voxels_each], VoxelBlocks::voxels_each, fines.block(b));
        std::copy_n(&volume[b * VoxelBlocks::voxels_each], VoxelBlocks::voxels_each,
                    water.block(b));
    }
    solid = SolidFraction(lattice_of(settings), static_cast<int>(settings.samples));
    ++revision;
}

} // namespace bris
