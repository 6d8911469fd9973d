#include "scenarios/track/lay_bays.hpp"

#include "components/boundary.hpp"
#include "components/fouling.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/recorder.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/loads/load.hpp"
#include "systems/loads/rail.hpp"
#include "systems/loads/spring_patch.hpp"
#include "systems/recorder/record_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

namespace bris {

namespace {

/// Where a copy of the bay lies: moved along x, and turned into its mirror image where `sign` is
/// -1.
struct Place {
    double origin, sign;
    Vec3 point(const Vec3& x) const { return {origin + sign * x.x(), x.y(), x.z()}; }
    Vec3 vector(const Vec3& v) const { return {sign * v.x(), v.y(), v.z()}; }
    /// Of rotations, rates and moments.
    Vec3 axial(const Vec3& v) const { return {v.x(), sign * v.y(), sign * v.z()}; }
    Quat attitude(const Quat& q) const { return {q.w(), q.x(), sign * q.y(), sign * q.z()}; }
    bool is_image() const { return sign < 0; }
};

/// Changes the values of a column, if the table has it, from a row on.
template <class C, class Change>
void change(Table& table, Row first, Change&& change_value) {
    if (!table.has<C>()) return;
    for (auto& value : table.column<C>().subspan(first)) change_value(value);
}

/// All State of bodies is either named here or changed by place_bodies: a new component that is not
/// would be copied as it is, which is wrong of a vector.
constexpr auto copied_as_they_are = std::to_array<std::string_view>(
    {"id", "motion", "material", "shape", "mass", "inertial_mass", "inertia", "inertial_inertia",
     "bounding_radius", "rail_tie", "fouling"});
constexpr auto placed = std::to_array<std::string_view>(
    {"position", "velocity", "acceleration", "drive_velocity", "angular_velocity",
     "step_angular_velocity", "angular_momentum", "orientation", "sampled_pose", "load", "patches",
     "recorder"});

void require_known(const Table& bodies) {
    for (const auto& column : bodies.columns())
        if (column->type().is_state && std::ranges::count(copied_as_they_are, column->type().name) +
                                               std::ranges::count(placed, column->type().name) ==
                                           0)
            throw std::logic_error("bays of a track: no mirror image of " + column->type().name);
}

void place_bodies(Table& bodies, Row first, const Place& place) {
    const auto polar = [&](Vec3& v) { v = place.vector(v); };
    const auto axial = [&](Vec3& v) { v = place.axial(v); };
    change<Position>(bodies, first, [&](Vec3& x) { x = place.point(x); });
    change<Velocity>(bodies, first, polar);
    change<Acceleration>(bodies, first, polar);
    change<DriveVelocity>(bodies, first, polar);
    change<AngularVelocity>(bodies, first, axial);
    change<StepAngularVelocity>(bodies, first, axial);
    change<AngularMomentum>(bodies, first, axial);
    change<Orientation>(bodies, first, [&](Quat& q) { q = place.attitude(q); });
    change<SampledPose>(bodies, first, [&](Pose& pose) {
        pose = {place.point(pose.position), place.attitude(pose.orientation)};
    });
}

/// Appends copies of these rows. Values that are not carried are zero.
Row append(Table& table, std::span<const Row> rows) {
    const std::size_t first = table.size();
    table.resize(first + rows.size());
    for (const auto& column : table.columns()) {
        if (!column->type().is_carried) continue;
        const std::size_t width = column->type().value_size;
        for (std::size_t k = 0; k < rows.size(); ++k)
            std::memcpy(column->bytes() + (first + k) * width, column->bytes() + rows[k] * width,
                        width);
    }
    return static_cast<Row>(first);
}

/// The image of a convex facet is seen from the grains in the other direction. A triangle repeats
/// its last corner.
FacetShape placed_facet(FacetShape shape, const Place& place) {
    for (Vec3& corner : shape.corners) corner = place.vector(corner);
    if (!place.is_image()) return shape;
    const auto& c = shape.corners;
    return c[2] == c[3] ? FacetShape{{c[0], c[2], c[1], c[1]}}
                        : FacetShape{{c[0], c[3], c[2], c[1]}};
}

/// Lays the copies of one bay.
class Bays {
public:
    Bays(World& world, unsigned bays, OwnBays own, EntityId once)
        : world_(world), bays_(bays), own_(own),
          bodies_(static_cast<EntityId>(world.table<Bodies>().size())), once_(once) {
        require_known(world.table<Bodies>());
        remove_plates();
        find_sides();
        list_rows();
    }

    void lay() {
        reserve();
        for (unsigned bay = 1; bay < bays_; ++bay) lay_bay(bay);
        if (own_.first > 0) remove_grains_of_first_bay();
        trim_facets();
        move_far_side();
        copy_resources();
        forget_lists(world_);
    }

private:
    Place place_of(unsigned bay) const {
        return bay % 2 == 0 ? Place{bay * width_, 1} : Place{(bay + 1) * width_, -1};
    }
    bool is_own(unsigned bay) const { return own_.first <= bay && bay < own_.last; }

    template <Kind K, class Keep>
    void keep_if(Keep&& keep) {
        Table& table = world_.table<K>();
        std::vector<Row> rows = all_rows(table.size());
        std::erase_if(rows, [&](Row r) { return !keep(r); });
        table.keep(rows);
    }

    void remove_plates() {
        auto& plates = world_.resource<BoxBodies>().plates;
        std::vector<char> is_plate(bodies_, 0);
        for (auto& of_lift : plates) {
            for (const CompactionPlate& plate : of_lift) is_plate[plate.body] = 1;
            of_lift.clear();
        }
        const auto id = world_.column<Bodies, BodyId>();
        keep_if<Bodies>([&](Row b) { return is_plate[id[b]] == 0; });
        facets_ = static_cast<EntityId>(world_.table<Facets>().size());
        const auto host = world_.column<Facets, HostId>();
        keep_if<Facets>([&](Row f) { return is_plate[host[f]] == 0; });
    }

    /// The sides of the bay are planes; those at right angles to x are mirrors.
    void find_sides() {
        const auto host = world_.column<Planes, HostId>();
        const auto plane = world_.column<Planes, LocalPlane>();
        is_wall_.assign(bodies_, 0);
        for (Row p = 0; p < plane.size(); ++p) {
            is_wall_[host[p]] = 1;
            if (plane[p].normal.x() < 0) {
                far_side_ = p;
                sides_ = host[p];
                width_ = plane[p].point.x();
            }
        }
        require(width_ > 0, "bays of a track: expected a bay with a side at its far end");
    }

    void list_rows() {
        const auto id = world_.column<Bodies, BodyId>();
        const auto parent = world_.column<Spheres, ParentId>();
        is_grain_.assign(bodies_, 0);
        for (const EntityId body : parent) is_grain_[body] = 1;
        // copies are numbered in an order that does not depend on that of the rows
        for (const Row b : in_order_of_ids(id)) {
            if (is_grain_[id[b]] != 0)
                grains_.push_back(b);
            else if (is_wall_[id[b]] == 0 && id[b] < once_)
                others_.push_back(b);
        }
        spheres_ = all_rows(parent.size());
        const auto host = world_.column<Facets, HostId>();
        for (Row f = 0; f < host.size(); ++f)
            if (host[f] < once_) facet_rows_.push_back(f);
        // the mirrors have no friction, so that nothing is kept of their contacts
        for_each_kind_of_pair([&]<class Pairs>() {
            if (!world_.has<Pairs>()) return;
            const Table& pairs = world_.table<Pairs>();
            if (pairs.has<Roll>() || pairs.has<Worn>())
                throw std::logic_error(
                    "bays of a track: no mirror image of what contacts remember");
            const auto key = pairs.column<PairKey>();
            const auto spring = pairs.column<Spring>();
            keep_if<Pairs>(
                [&](Row p) { return Spring::keep(spring[p]) && key[p].partner != sides_; });
            pairs_.push_back(all_rows(pairs.size()));
        });
    }

    /// Memory for all rows at once.
    void reserve() {
        const std::size_t own = own_.last - own_.first + (own_.first > 0 ? 1 : 0);
        const auto times = [&](Table& table, std::size_t every, std::size_t of_own) {
            const std::size_t now = table.size();
            table.resize(now + (bays_ - 1) * every + (own - 1) * of_own);
            table.resize(now);
        };
        times(world_.table<Bodies>(), others_.size(), grains_.size());
        times(world_.table<Spheres>(), 0, spheres_.size());
        times(world_.table<Facets>(), facet_rows_.size(), 0);
        for_each_kind_of_pair([&]<class Pairs>() {
            if (world_.has<Pairs>()) times(world_.table<Pairs>(), 0, world_.table<Pairs>().size());
        });
    }

    void lay_bay(unsigned bay) {
        const Place place = place_of(bay);
        const EntityId shift = bay * bodies_;
        const auto shifted = [&](EntityId& id) { id += shift; };
        Table &bodies = world_.table<Bodies>(), &facets = world_.table<Facets>();
        const Row body = append(bodies, others_);
        if (is_own(bay)) append(bodies, grains_);
        place_bodies(bodies, body, place);
        change<BodyId>(bodies, body, shifted);
        change<RecorderOf>(bodies, body, [](std::uint32_t& number) { number = 0; });
        renumber<LoadOf, Loads>(body, [&](Load& load) {
            load.force = place.vector(load.force);
            load.couple = place.axial(load.couple);
            load.point = place.vector(load.point);
        });
        renumber<PatchesOf, SpringPatches>(body, [&](SpringPatch& patch) {
            patch.point = place.vector(patch.point);
            patch.anchor = place.point(patch.anchor);
            patch.axis = place.vector(patch.axis);
        });
        const Row facet = append(facets, facet_rows_);
        change<FacetId>(facets, facet, [&](EntityId& id) { id += bay * facets_; });
        change<HostId>(facets, facet, shifted);
        change<LocalFacet>(facets, facet,
                           [&](FacetShape& shape) { shape = placed_facet(shape, place); });
        if (is_own(bay)) lay_grains(bay);
    }

    void lay_grains(unsigned bay) {
        const Place place = place_of(bay);
        const EntityId shift = bay * bodies_;
        Table& spheres = world_.table<Spheres>();
        const Row sphere = append(spheres, spheres_);
        change<SphereId>(spheres, sphere,
                         [&](EntityId& id) { id += bay * static_cast<EntityId>(spheres_.size()); });
        change<ParentId>(spheres, sphere, [&](EntityId& id) { id += shift; });
        change<LocalBall>(spheres, sphere,
                          [&](Ball& ball) { ball.centre = place.vector(ball.centre); });
        auto rows = pairs_.begin();
        for_each_kind_of_pair([&]<class Pairs>() {
            if (!world_.has<Pairs>()) return;
            Table& pairs = world_.table<Pairs>();
            const Row pair = append(pairs, *rows++);
            change<PairKey>(pairs, pair, [&](PairNames& names) {
                names.owner += shift;
                if (!std::is_same_v<Pairs, PlanePairs>) names.partner += shift;
                if (std::is_same_v<Pairs, FacetPairs>) names.feature += bay * facets_;
            });
            change<Spring>(pairs, pair, [&](SpringRow& spring) { spring.x *= place.sign; });
        });
    }

    /// Gives the bodies from a row on elements of their own, made of those of the first bay.
    template <class Number, class List, class Change>
    void renumber(Row first, Change&& change_element) {
        auto& lists = world_.resource<List>().of_body;
        change<Number>(world_.table<Bodies>(), first, [&](std::uint32_t& number) {
            if (number == 0) return;
            lists.push_back(lists[number - 1]);
            for (auto& element : lists.back()) change_element(element);
            number = static_cast<std::uint32_t>(lists.size());
        });
    }

    void remove_grains_of_first_bay() {
        const auto is_of_others = [&](EntityId id) { return id >= bodies_ || is_grain_[id] == 0; };
        const auto id = world_.column<Bodies, BodyId>();
        keep_if<Bodies>([&](Row b) { return is_of_others(id[b]); });
        const auto parent = world_.column<Spheres, ParentId>();
        keep_if<Spheres>([&](Row s) { return is_of_others(parent[s]); });
        for_each_kind_of_pair([&]<class Pairs>() {
            if (!world_.has<Pairs>()) return;
            const auto key = world_.column<Pairs, PairKey>();
            keep_if<Pairs>([&](Row p) { return is_of_others(key[p].owner); });
        });
    }

    /// Plates and bladders reach beyond the sides of a bay, but not into the next one.
    void trim_facets() {
        Table& facets = world_.table<Facets>();
        const auto host = facets.column<HostId>();
        const auto shape = facets.column<LocalFacet>();
        const RowIndex row_of(world_.column<Bodies, BodyId>());
        const auto position = world_.column<Bodies, Position>();
        constexpr double far = std::numeric_limits<double>::infinity();
        for (Row f = 0; f < shape.size(); ++f) {
            if (const EntityId body = host[f] % bodies_; body >= once_) continue;
            const unsigned bay = host[f] / bodies_;
            const double at = position[row_of[host[f]]].x(),
                         low = bay > 0 ? bay * width_ - at : -far,
                         high = bay + 1 < bays_ ? (bay + 1) * width_ - at : far;
            for (Vec3& corner : shape[f].corners) corner.x() = std::clamp(corner.x(), low, high);
        }
    }

    void move_far_side() {
        world_.column<Planes, LocalPlane>()[far_side_].point.x() = bays_ * width_;
        auto& limits = world_.resource<Limits>();
        limits.high.x() += (bays_ - 1) * width_;
    }

    void copy_resources() {
        auto& box = world_.resource<BoxBodies>();
        const auto copy = [&](std::vector<EntityId>& ids) {
            const std::vector<EntityId> first = ids;
            for (unsigned bay = 1; bay < bays_; ++bay)
                for (const EntityId id : first) ids.push_back(id + bay * bodies_);
        };
        copy(box.ties);
        copy(box.subgrade);
        for (auto& rocks : box.rocks) copy(rocks);
        for (auto& planned : box.planned) planned = {};
        record_in(bays_ / 2);
    }

    void record_in(unsigned bay) {
        auto& box = world_.resource<BoxBodies>();
        const RowIndex row_of(world_.column<Bodies, BodyId>());
        const auto number = world_.column<Bodies, RecorderOf>();
        auto& recorders = world_.resource<InertialRecorders>().list;
        const auto is_here = [&](EntityId id) { return row_of[id] != no_row; };
        for (std::size_t k = 0; k < recorders.size(); ++k) {
            EntityId& body = recorders[k].body;
            if (is_here(body)) number[row_of[body]] = 0;
            body += bay * bodies_;
            if (is_here(body)) number[row_of[body]] = static_cast<std::uint32_t>(k + 1);
        }
        for (BoxSensor& sensor : box.sensors) {
            sensor.body += bay * bodies_;
            sensor.place = place_of(bay).point(sensor.place);
        }
    }

    World& world_;
    unsigned bays_;
    OwnBays own_;
    EntityId bodies_, once_, facets_ = 0;  ///< of one bay
    EntityId sides_ = nobody;              ///< the mirrors
    double width_ = 0;                     ///< m, of a bay
    Row far_side_ = 0;                     ///< of Planes
    std::vector<char> is_wall_, is_grain_; ///< by id
    std::vector<Row> grains_, others_, spheres_, facet_rows_;
    std::vector<std::vector<Row>> pairs_; ///< by kind
};

} // namespace

void lay_bays(World& world, unsigned bays, OwnBays own, EntityId once) {
    Bays(world, bays, own, once).lay();
}

} // namespace bris
