#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "engine/archive.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"
#include "engine/rows.hpp"
#include "engine/system.hpp"
#include "engine/world.hpp"

#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace bris {

/// Force (N) and torque about Position (N m).
struct Wrench {
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
};

/// A spring and a dashpot by which a force element holds a body.
struct BodySpring {
    Row body;
    double stiffness, damping; ///< N/m, N s/m
    Vec3 arm, axis;            ///< m, from Position, and a unit vector; both in the world frame
};

/// What a kind of force elements states (ForceElement, table.hpp) and most kinds leave as it is.
struct ElementDefaults {
    /// Column of Bodies with the work (J) that elements have done on each body, and one with the
    /// energy that their dashpots have taken. They exist with an energy budget.
    using Work = void;
    using Loss = void;
    /// Systems that accumulate these, once all forces on the bodies are complete.
    static StepList work_systems() { return {}; }
    /// Elastic energy, J, at the present positions.
    static double energy(const World&) { return 0; }
    /// Appends the springs of all bodies, for the stable step and the scaling of masses.
    static void add_springs(const World&, std::vector<BodySpring>&) {}
    /// Whether a change of the force wakes a sleeping body.
    static constexpr bool wakes_bodies = false;
    /// Whether the force is added to the weight before the magnitudes of forces are summed
    /// (OuterForces).
    static constexpr bool counts_as_weight = false;
};

/// Mean velocities of a free clump over the kick of a step. With them the work of a force is that
/// which the leapfrog itself does.
struct MeanMotion {
    Vec3 velocity, angular_velocity;
};

/// `bodies`: rows with what determines the motion of a clump; Force and Torque must be complete.
template <class BodyRows>
MeanMotion mean_motion(const BodyRows& bodies, Row b, double dt) {
    const Quat& q = bodies.template column<Orientation>()[b];
    const Vec3 momentum = bodies.template column<AngularMomentum>()[b] +
                          0.5 * dt * bodies.template column<Torque>()[b];
    const Vec3 local =
        (q.conjugate() * momentum).cwiseQuotient(bodies.template column<InertialInertia>()[b]);
    return {bodies.template column<Velocity>()[b] + 0.5 * dt * bodies.template column<Force>()[b] /
                                                        bodies.template column<InertialMass>()[b],
            q * local};
}

/// Velocity of a point of a clump at the time of the positions, predicted with the last
/// acceleration, as that of a contact is. `arm`: m, from Position, in the world frame.
template <class BodyRows>
Vec3 point_velocity(const BodyRows& bodies, Row b, const Vec3& arm, double dt) {
    return bodies.template column<Velocity>()[b] +
           0.5 * dt * bodies.template column<Acceleration>()[b] +
           bodies.template column<AngularVelocity>()[b].cross(arm);
}

/// Throws InputError in a scene of single spheres; `what`: the first word of the message.
void require_clumps(const World& world, const char* what);
/// The row of a free body in a scene of clumps. Throws InputError if it is none.
Row row_of_free_clump(const World& world, EntityId body, const char* what);

namespace detail {

/// Appends the numbers of a value: a number or flag, a vector, a list, or what `fields` ties.
template <class T>
void put(std::vector<double>& to, const T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
        to.push_back(static_cast<double>(value));
    } else if constexpr (requires { T::fields(value); }) {
        std::apply([&](const auto&... field) { (put(to, field), ...); }, T::fields(value));
    } else {
        if constexpr (!std::is_same_v<T, Vec3>) to.push_back(static_cast<double>(value.size()));
        for (const auto& x : value) put(to, x);
    }
}

/// Reads in order what `put` wrote.
class NumberReader {
public:
    explicit NumberReader(std::vector<double> numbers) : numbers_(std::move(numbers)) {}
    template <class T>
    void get(T& value) {
        if constexpr (std::is_arithmetic_v<T>) {
            value = static_cast<T>(numbers_.at(at_++));
        } else if constexpr (requires { T::fields(value); }) {
            std::apply([&](auto&... field) { (get(field), ...); }, T::fields(value));
        } else {
            if constexpr (!std::is_same_v<T, Vec3>)
                value.resize(static_cast<std::size_t>(numbers_.at(at_++)));
            for (auto& x : value) get(x);
        }
    }

private:
    std::vector<double> numbers_;
    std::size_t at_ = 0;
};

} // namespace detail

/// Saves a list of elements, or of lists of them. `fields` of an element ties its numbers, vectors
/// and lists.
template <class List>
void save_elements(Archive& archive, const char* path, const List& list) {
    std::vector<double> numbers;
    detail::put(numbers, list);
    archive.put(path, std::span<const double>(numbers));
}
template <class List>
void load_elements(const Archive& archive, const char* path, List& list) {
    detail::NumberReader(archive.get<double>(path)).get(list);
}

/// Lists of elements that act on one body each.
template <class Item>
struct ElementLists {
    std::vector<std::vector<Item>> of_body; ///< by the number of the body, minus 1

    /// The list of the body of a row, which has the column Number: 1 + index in of_body; 0: none.
    template <class Number>
    std::vector<Item>& list(World& world, Row row) {
        std::uint32_t& number = world.table<Bodies>().add<Number>()[row];
        if (number == 0) {
            of_body.emplace_back();
            number = static_cast<std::uint32_t>(of_body.size());
        }
        return of_body[number - 1];
    }
};

} // namespace bris
