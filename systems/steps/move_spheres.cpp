#include "systems/steps/move_spheres.hpp"

#include "engine/lane_math.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/body_sums.hpp"
#include "systems/contact/sum_contacts.hpp"
#include "systems/guard.hpp"
#include "systems/slabs/slabs.hpp"

namespace bris {

namespace {

using detail::SumRows;
using Places = Rows<Listed, ListedPosition>;

/// Resources that the combined systems read.
struct Settings {
    const ForceGrid& grid;
    const Census& census;
    const BoundarySums& boundaries;
    const Gravity& gravity;
    const Limits& limits;
    const Clock& clock;
};

/// The combined systems themselves, for groups of rows with a boundary and for incomplete ones.
void move_bodies(const MovedSpheres& bodies, const SumRows& sums, const Places& listed,
                 const Settings& s, ListState& lists, Alarm& alarm) {
    sum_contacts(bodies, sums, s.grid, s.census, s.boundaries);
    apply_gravity(bodies, s.gravity);
    integrate(bodies, s.clock);
    rotate_spheres(bodies, s.clock);
    update_sphere_positions(bodies, listed);
    update_kicks(bodies, s.clock);
    bound_displacement(bodies, lists);
    watch_motion(bodies, s.limits, s.clock, s.census, alarm);
}

/// Moves lane_count spheres at a time.
class SphereGroups {
public:
    SphereGroups(const MovedSpheres& bodies, const SumRows& sums, const Places& listed,
                 const Settings& s, bool observed)
        : bodies_(bodies), sums_(bodies, sums, s.grid, s.census, s.boundaries),
          sphere_(listed.column<ListedPosition>()),
          within_(s.limits, s.clock, s.census), gravity_{lanes(s.gravity.value.x()),
                                                         lanes(s.gravity.value.y()),
                                                         lanes(s.gravity.value.z())},
          dt_(s.clock.dt), observed_(observed) {}

    /// Moves the spheres from row `first` on. Sets used_up() and escaped() if one of them calls for
    /// it.
    void move(Row first) {
        const LaneRows rows{first, lane_count};
        const LaneMask free =
            equal(bodies_.column<MotionOf>(), rows, static_cast<std::uint32_t>(Motion::free));
        if (bits(free) == all_lanes)
            move<true>(rows, free);
        else
            move<false>(rows, free);
    }
    bool used_up() const { return bits(near_) != all_lanes; }
    bool escaped() const { return bits(allowed_) != all_lanes; }

private:
    template <bool all_free>
    [[gnu::always_inline]] void move(LaneRows rows, LaneMask free) {
        detail::NetForceLanes net = sums_.take_grains(rows.first);
        net.force = net.force + number<Mass>(rows) * gravity_;
        if (observed_) { // nothing else reads the forces on spheres
            put<Force>(rows, net.force);
            put<Torque>(rows, net.torque);
        }
        const Lane mass = number<InertialMass>(rows),
                   inverse_inertia = 1.0 / number<SphereInertia>(rows);
        // without branches where all are free
        const auto chosen = [&](const Vec3Lanes& moved, auto&& driven) {
            if constexpr (all_free)
                return moved;
            else
                return select(free, moved, driven());
        };
        const Vec3Lanes a = chosen({net.force.x / mass, net.force.y / mass, net.force.z / mass},
                                   [] { return Vec3Lanes{}; }),
                        v = chosen(vector<Velocity>(rows) + dt_ * a,
                                   [&] { return vector<DriveVelocity>(rows); }),
                        x = vector<Position>(rows) + dt_ * v,
                        before = vector<AngularMomentum>(rows), after = before + dt_ * net.torque,
                        momentum = chosen(after, [&] { return before; }),
                        omega = chosen(inverse_inertia * (after + 0.5 * dt_ * net.torque),
                                       [&] { return vector<AngularVelocity>(rows); }),
                        step_omega = chosen(inverse_inertia * after,
                                            [&] { return vector<StepAngularVelocity>(rows); });
        put<Acceleration>(rows, a);
        put<Velocity>(rows, v);
        put<Position>(rows, x);
        put<AngularMomentum>(rows, momentum);
        put<AngularVelocity>(rows, omega);
        put<StepAngularVelocity>(rows, step_omega);
        show_contacts(rows, x, v, step_omega, free ? 1.0 / mass : Lane{});
        predict(rows, (0.5 * dt_) * a, omega - step_omega);
        const Vec3Lanes gone = x - vector<PrunedAt>(rows);
        const Lane distance = sqrt(dot(gone, gone));
        store(bodies_.column<DisplacementBound>(), rows, distance);
        near_ &= distance <= number<InnerSkin>(rows);
        allowed_ &= within_.allow(x, v, omega, distance, number<BoundingRadius>(rows), free);
    }
    template <class C>
    Lane number(LaneRows rows) const {
        return load(bodies_.column<C>(), rows);
    }
    template <class C>
    Vec3Lanes vector(LaneRows rows) const {
        return load(bodies_.column<C>(), rows);
    }
    template <class C>
    void put(LaneRows rows, const Vec3Lanes& v) const {
        store(bodies_.column<C>(), rows, v);
    }
    /// What contacts read of the spheres.
    void show_contacts(LaneRows rows, const Vec3Lanes& x, const Vec3Lanes& v, const Vec3Lanes& w,
                       const Lane& inverse_mass) const {
        MotionRow* motion = bodies_.column<RigidMotion>() + rows.first;
        SphereRow* sphere = sphere_ + rows.first;
        const Lane radius = transpose(load_rows([&](int q) { return &sphere[q].x; }))[3];
        store_rows(transpose({x.x, x.y, x.z, radius}), lane_count,
                   [&](int q) { return &sphere[q].x; });
        store_rows(transpose({v.x, v.y, v.z, inverse_mass}), lane_count,
                   [&](int q) { return &motion[q].vx; });
        store_rows(transpose({w.x, w.y, w.z, Lane{}}), lane_count,
                   [&](int q) { return &motion[q].omega_x; });
    }
    /// What only dashpots read.
    void predict(LaneRows rows, const Vec3Lanes& v, const Vec3Lanes& w) const {
        KickRow* kick = bodies_.column<Kick>() + rows.first;
        store_rows(transpose({v.x, v.y, v.z, Lane{}}), lane_count,
                   [&](int q) { return &kick[q].vx; });
        store_rows(transpose({w.x, w.y, w.z, Lane{}}), lane_count,
                   [&](int q) { return &kick[q].omega_x; });
    }

    MovedSpheres bodies_;
    detail::BodySums sums_;
    SphereRow* sphere_;
    MotionLimits within_;
    Vec3Lanes gravity_;
    double dt_;
    bool observed_;
    LaneMask near_ = ~LaneMask{}, allowed_ = ~LaneMask{};
};

} // namespace

void move_spheres(MovedSpheres bodies, SumRows sums, Places listed, const ForceGrid& grid,
                  const Census& census, const BoundarySums& boundaries, const Gravity& gravity,
                  const Limits& limits, const Clock& clock, const Observation& observation,
                  ListState& lists, Alarm& alarm) {
    const Settings settings{grid, census, boundaries, gravity, limits, clock};
    SphereGroups groups(bodies, sums, listed, settings, observation.due);
    auto boundary = std::ranges::lower_bound(census.boundaries, bodies.first());
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const Row last = rows.first + static_cast<Row>(rows.count);
        while (boundary != census.boundaries.end() && *boundary < rows.first) ++boundary;
        const bool has_boundary = boundary != census.boundaries.end() && *boundary < last;
        if (rows.count == lane_count && !has_boundary)
            groups.move(rows.first);
        else
            move_bodies(bodies.over({rows.first, last}), sums, listed, settings, lists, alarm);
    });
    if (groups.used_up()) lists.note_used_up();
    if (groups.escaped()) alarm.raise();
}

void move_spheres_of_slab(MovedSpheres bodies, SumRows sums, Places listed, const ForceGrid& grid,
                          const Census& census, const BoundarySums& boundaries,
                          const Gravity& gravity, const Limits& limits, const Clock& clock,
                          const Observation& observation, Slab& slab, ListState& lists,
                          Alarm& alarm) {
    constexpr std::size_t rows_per_chunk = 512; // a multiple of the lanes
    const auto over = [&](RowRange all, auto&& body) {
        for_chunks(all.size(), rows_per_chunk,
                   [&](std::size_t, std::size_t first, std::size_t last) {
                       body(bodies.over({all.first + static_cast<Row>(first),
                                         all.first + static_cast<Row>(last)}));
                   });
    };
    const RowRange ghosts{slab.first_ghost, static_cast<Row>(bodies.size())};
    over({0, ghosts.first}, [&](const MovedSpheres& own) {
        move_spheres(own, sums, listed, grid, census, boundaries, gravity, limits, clock,
                     observation, lists, alarm);
    });
    pass_spheres(bodies, slab);
    over(ghosts, [&](const MovedSpheres& others) {
        sum_contacts(others, sums, grid, census, boundaries); // clears them
        update_sphere_positions(others, listed);
        update_kicks(others, clock);
        bound_displacement(others, lists);
        watch_motion(others, limits, clock, census, alarm);
    });
}

} // namespace bris
