#include "systems/steps/move_spheres.hpp"

#include "engine/lane_math.hpp"
#include "engine/parallel.hpp"
#include "engine/prefetch.hpp"
#include "systems/contact/body_sums.hpp"
#include "systems/contact/sum_contacts.hpp"
#include "systems/guard.hpp"
#include "systems/slabs/slabs.hpp"

#include <utility>

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

/// Calls body(chunk) for chunks of the rows `all`, in parallel.
template <class Body>
void for_chunks_of(const MovedSpheres& bodies, RowRange all, Body&& body) {
    constexpr std::size_t rows_per_chunk = 512; // a multiple of the lanes
    for_chunks(all.size(), rows_per_chunk, [&](std::size_t, std::size_t first, std::size_t last) {
        body(
            bodies.over({all.first + static_cast<Row>(first), all.first + static_cast<Row>(last)}));
    });
}

/// Writes the columns of motion of bodies with spheres from what contacts read of them.
void write_columns(const MovedSpheres& bodies, const Places& listed) {
    const SphereRow* sphere = listed.column<ListedPosition>();
    const MotionRow* motion = bodies.column<RigidMotion>();
    const KickRow* kick = bodies.column<Kick>();
    const SphereRun* spheres = bodies.column<SpheresOf>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (spheres[b].count == 0) continue; // a boundary's are always current
        store(bodies.column<Position>()[b], load(&sphere[b].x));
        store(bodies.column<Velocity>()[b], load(&motion[b].vx));
        store(bodies.column<StepAngularVelocity>()[b], load(&motion[b].omega_x));
        store(bodies.column<Acceleration>()[b], load(&kick[b].ax));
        bodies.column<AngularVelocity>()[b] = {kick[b].spin_x, kick[b].spin_y, motion[b].spin_z};
    }
}

/// Writes the spins, as write_columns reads them, of bodies whose columns are current.
void keep_spins(const MovedSpheres& bodies) {
    MotionRow* motion = bodies.column<RigidMotion>();
    KickRow* kick = bodies.column<Kick>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const Vec3& spin = bodies.column<AngularVelocity>()[b];
        kick[b].spin_x = spin.x();
        kick[b].spin_y = spin.y();
        motion[b].spin_z = spin.z();
    }
}

/// At the end of a step, which may have left columns unwritten.
void complete_motion_of_step(const MovedSpheres& bodies, const Places& listed,
                             MotionColumns& columns, ListState& lists) {
    columns.current = !std::exchange(columns.skipped, false);
    complete_motion(bodies, listed, columns, lists);
}

/// The combined systems themselves, for groups of rows with a boundary and for incomplete ones.
void move_bodies(const MovedSpheres& bodies, const SumRows& sums, const Places& listed,
                 const Settings& s, ListState& lists, Alarm& alarm) {
    sum_contacts(bodies, sums, s.grid, s.census, s.boundaries, alarm);
    apply_gravity(bodies, s.gravity);
    integrate(bodies, s.clock);
    rotate_spheres(bodies, s.clock);
    update_sphere_positions(bodies, listed);
    update_kicks(bodies);
    keep_spins(bodies);
    bound_displacement(bodies, lists);
    watch_motion(bodies, s.limits, s.clock, s.census, alarm);
}

/// Moves lane_count spheres at a time.
class SphereGroups {
public:
    SphereGroups(const MovedSpheres& bodies, const SumRows& sums, const Places& listed,
                 const Settings& s, bool observed, const MotionColumns& columns)
        : bodies_(bodies), sums_(bodies, sums, s.grid, s.census, s.boundaries),
          sphere_(listed.column<ListedPosition>()),
          within_(s.limits, s.clock, s.census), gravity_{lanes(s.gravity.value.x()),
                                                         lanes(s.gravity.value.y()),
                                                         lanes(s.gravity.value.z())},
          dt_(s.clock.dt), observed_(observed), columns_are_due_(columns.due),
          columns_are_current_(columns.current) {
        sums_.prefetch_lists(bodies.first(), bodies.last());
    }

    /// Moves the spheres from row `first` on. Sets used_up() and alarmed() if one of them calls for
    /// it.
    void move(Row first) {
        const LaneRows rows{first, lane_count};
        if (far_) prefetch_group(first + 4 * lane_count);
        const LaneMask free =
            equal(bodies_.column<MotionOf>(), rows, static_cast<std::uint32_t>(Motion::free));
        if (bits(free) == all_lanes)
            move<true>(rows, free);
        else
            move<false>(rows, free);
    }
    bool used_up() const { return bits(near_) != all_lanes; }
    bool alarmed() const { return bits(allowed_) != all_lanes; }

private:
    /// Number of spheres whose rows fill a cache of some ten megabytes.
    static constexpr std::size_t spheres_in_cache = 20000;

    /// Prefetches the rows of lane_count spheres. They lie in more places than the processor
    /// follows by itself.
    void prefetch_group(Row first) const {
        if (first + lane_count > bodies_.size()) return;
        const auto rows_of = [&](const auto* table) {
            const auto* at = reinterpret_cast<const char*>(table + first);
            for (std::size_t k = 0; k < lane_count * sizeof *table; k += 64) prefetch<true>(at + k);
        };
        rows_of(sums_.rows());
        rows_of(sphere_);
        rows_of(bodies_.column<RigidMotion>());
        rows_of(bodies_.column<Kick>());
        rows_of(bodies_.column<AngularMomentum>());
        rows_of(bodies_.column<PrunedAt>());
        rows_of(bodies_.column<Mass>());
        rows_of(bodies_.column<InertialMass>());
        rows_of(bodies_.column<SphereInertia>());
        rows_of(bodies_.column<InnerSkin>());
        rows_of(bodies_.column<BoundingRadius>());
    }
    template <bool all_free>
    [[gnu::always_inline]] void move(LaneRows rows, LaneMask free) {
        detail::NetForceLanes net = sums_.take_grains(rows.first);
        net.force = net.force + number<Mass>(rows) * gravity_;
        if (observed_) { // nothing else reads the forces on spheres
            put<Force>(rows, net.force);
            put<Torque>(rows, net.torque);
        }
        SphereRow* sphere = sphere_ + rows.first;
        MotionRow* motion = bodies_.column<RigidMotion>() + rows.first;
        const FourLanes place = columns_of([&](int q) { return &sphere[q].x; }),
                        moving = columns_of([&](int q) { return &motion[q].vx; });
        const Lane mass = number<InertialMass>(rows),
                   inverse_inertia = 1.0 / number<SphereInertia>(rows);
        Vec3Lanes from = vector_of(place), velocity = vector_of(moving);
        Lane inverse_mass = moving[3];
        if (columns_are_current_) { // somebody may have changed them from outside the step
            from = vector<Position>(rows);
            velocity = vector<Velocity>(rows);
            inverse_mass = free ? 1.0 / mass : Lane{};
        }
        // without branches where all are free
        const auto chosen = [&](const Vec3Lanes& moved, auto&& driven) {
            if constexpr (all_free)
                return moved;
            else
                return select(free, moved, driven());
        };
        const Vec3Lanes a = chosen({net.force.x / mass, net.force.y / mass, net.force.z / mass},
                                   [] { return Vec3Lanes{}; }),
                        v = chosen(velocity + dt_ * a, [&] { return vector<DriveVelocity>(rows); }),
                        x = from + dt_ * v, before = vector<AngularMomentum>(rows),
                        after = before + dt_ * net.torque,
                        momentum = chosen(after, [&] { return before; }),
                        omega = chosen(inverse_inertia * (after + 0.5 * dt_ * net.torque),
                                       [&] { return vector<AngularVelocity>(rows); }),
                        step_omega = chosen(inverse_inertia * after, [&] {
                            return columns_are_current_ ? vector<StepAngularVelocity>(rows)
                                                        : vector_of(columns_of([&](int q) {
                                                              return &motion[q].omega_x;
                                                          }));
                        });
        put<AngularMomentum>(rows, momentum);
        if (columns_are_due_) {
            put<Acceleration>(rows, a);
            put<AngularVelocity>(rows, omega);
            put<Velocity>(rows, v);
            put<Position>(rows, x);
            put<StepAngularVelocity>(rows, step_omega);
        }
        const auto write = [](const Vec3Lanes& first, const Lane& fourth, auto&& row_of) {
            store_rows(transpose({first.x, first.y, first.z, fourth}), lane_count, row_of);
        };
        write(x, place[3], [&](int q) { return &sphere[q].x; });
        write(v, inverse_mass, [&](int q) { return &motion[q].vx; });
        write(step_omega, omega.z, [&](int q) { return &motion[q].omega_x; });
        predict(rows, a, omega - step_omega, omega);
        const Vec3Lanes gone = x - vector<PrunedAt>(rows);
        const Lane distance = sqrt(dot(gone, gone));
        if (columns_are_due_) store(bodies_.column<DisplacementBound>(), rows, distance);
        near_ &= distance <= number<InnerSkin>(rows);
        allowed_ &=
            net.held & within_.allow(x, v, omega, distance, number<BoundingRadius>(rows), free);
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
    template <class RowOf>
    static FourLanes columns_of(RowOf&& row_of) {
        return transpose(load_rows(row_of));
    }
    static Vec3Lanes vector_of(const FourLanes& rows) { return {rows[0], rows[1], rows[2]}; }
    /// What only dashpots read.
    void predict(LaneRows rows, const Vec3Lanes& a, const Vec3Lanes& w,
                 const Vec3Lanes& omega) const {
        KickRow* kick = bodies_.column<Kick>() + rows.first;
        store_rows(transpose({a.x, a.y, a.z, omega.x}), lane_count,
                   [&](int q) { return &kick[q].ax; });
        store_rows(transpose({w.x, w.y, w.z, omega.y}), lane_count,
                   [&](int q) { return &kick[q].omega_x; });
    }

    MovedSpheres bodies_;
    detail::BodySums sums_;
    SphereRow* sphere_;
    MotionLimits within_;
    Vec3Lanes gravity_;
    double dt_;
    bool far_ = bodies_.size() > spheres_in_cache, observed_, columns_are_due_,
         columns_are_current_;
    LaneMask near_ = ~LaneMask{}, allowed_ = ~LaneMask{};
};

} // namespace

void move_spheres(MovedSpheres bodies, SumRows sums, Places listed, const ForceGrid& grid,
                  const Census& census, const BoundarySums& boundaries, const Gravity& gravity,
                  const Limits& limits, const Clock& clock, const Observation& observation,
                  MotionColumns& columns, ListState& lists, Alarm& alarm) {
    const Settings settings{grid, census, boundaries, gravity, limits, clock};
    SphereGroups groups(bodies, sums, listed, settings, observation.due, columns);
    auto boundary = std::ranges::lower_bound(census.boundaries, bodies.first());
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const Row last = rows.first + static_cast<Row>(rows.count);
        while (boundary != census.boundaries.end() && *boundary < rows.first) ++boundary;
        const bool has_boundary = boundary != census.boundaries.end() && *boundary < last;
        if (rows.count == lane_count && !has_boundary) {
            groups.move(rows.first);
        } else {
            const MovedSpheres these = bodies.over({rows.first, last});
            if (!columns.current) write_columns(these, listed);
            move_bodies(these, sums, listed, settings, lists, alarm);
        }
    });
    if (groups.used_up()) lists.note_used_up();
    if (groups.alarmed()) alarm.raise();
    if (!columns.due) columns.note_skipped();
}

void complete_motion(MovedSpheres bodies, Places listed, MotionColumns& columns, ListState& lists) {
    if (columns.current) return;
    for_chunks_of(bodies, {0, static_cast<Row>(bodies.size())}, [&](const MovedSpheres& these) {
        write_columns(these, listed);
        bound_displacement(these, lists);
    });
    columns.current = true;
}

void complete_motion_in_trouble(MovedSpheres bodies, Places listed, const Alarm& alarm,
                                const Health& health, MotionColumns& columns, ListState& lists) {
    if (alarm.raised || health.bad) complete_motion_of_step(bodies, listed, columns, lists);
}

void complete_motion_for_ranks(MovedSpheres bodies, Places listed, const Slab&,
                               const Health& health, MotionColumns& columns, ListState& lists) {
    if (lists.used_up || health.bad) complete_motion_of_step(bodies, listed, columns, lists);
}

void move_spheres_of_slab(MovedSpheres bodies, SumRows sums, Places listed, const ForceGrid& grid,
                          const Census& census, const BoundarySums& boundaries,
                          const Gravity& gravity, const Limits& limits, const Clock& clock,
                          const Observation& observation, MotionColumns& columns, Slab& slab,
                          ListState& lists, Alarm& alarm) {
    const RowRange ghosts{slab.first_ghost, static_cast<Row>(bodies.size())};
    for_chunks_of(bodies, {0, ghosts.first}, [&](const MovedSpheres& own) {
        move_spheres(own, sums, listed, grid, census, boundaries, gravity, limits, clock,
                     observation, columns, lists, alarm);
    });
    if (!columns.due) // others read no columns but those that are passed on
        for (const GhostRows& ghost : slab.ghosts)
            for (const Row b : ghost.send) write_columns(bodies.over({b, b + 1}), listed);
    pass_spheres(bodies, slab);
    for_chunks_of(bodies, ghosts, [&](const MovedSpheres& others) {
        sum_contacts(others, sums, grid, census, boundaries, alarm); // clears them
        update_sphere_positions(others, listed);
        update_kicks(others);
        keep_spins(others);
        bound_displacement(others, lists);
        watch_motion(others, limits, clock, census, alarm);
    });
}

} // namespace bris
