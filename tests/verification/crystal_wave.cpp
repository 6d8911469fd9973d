#include "tests/verification/crystal_wave.hpp"

#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/collision/peak.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// Layers of a crystal along x, each with its free sphere and the images of this sphere.
class Layers {
public:
    Layers(World& world, const Crystal& s, double radius, std::uint32_t material, std::size_t count)
        : around_(neighbours(s.lattice)) {
        for (Vec3& n : around_) n *= s.spacing;
        const Vec3 next = around_.back(); // in the layer above, since neighbours are sorted by x
        height_ = next.x();
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 shift = k % 2 == 0 ? Vec3(Vec3::Zero()) : Vec3(0, next.y(), next.z());
            const Vec3 site = static_cast<double>(k) * height_ * Vec3::UnitX() + shift;
            const bool outermost = k == 0 || k + 1 == count;
            layers_.push_back({{add_sphere(world, site, radius, material,
                                           outermost ? Motion::fixed : Motion::free),
                                site}});
        }
        for (std::size_t k = 1; k + 1 < count; ++k)
            for (const Vec3& n : around_) {
                const Vec3 site = layers_[k].front().site + n;
                auto& layer = layers_[static_cast<std::size_t>(std::lround(site.x() / height_))];
                const auto here = [&](const Member& m) {
                    return (m.site - site).norm() < 1e-6 * height_;
                };
                if (std::none_of(layer.begin(), layer.end(), here))
                    layer.push_back(
                        {add_sphere(world, site, radius, material, Motion::fixed), site});
            }
    }

    double height() const { return height_; } ///< m, distance of layers
    EntityId sphere(std::size_t layer) const { return layers_[layer].front().id; }

    void move_images(World& world) const {
        for (const auto& layer : layers_) {
            const Member& free = layer.front();
            const Vec3 x = value_of<Position>(world, free.id) - free.site,
                       v = value_of<Velocity>(world, free.id);
            const Vec3 angular_velocity = value_of<AngularVelocity>(world, free.id),
                       step_angular_velocity = value_of<StepAngularVelocity>(world, free.id);
            for (auto image = layer.begin() + 1; image != layer.end(); ++image) {
                value_of<Position>(world, image->id) = image->site + x;
                value_of<Velocity>(world, image->id) = v;
                value_of<AngularVelocity>(world, image->id) = angular_velocity;
                value_of<StepAngularVelocity>(world, image->id) = step_angular_velocity;
            }
        }
        show_velocities(world); // displacements are far smaller than the lists' skin
    }

private:
    struct Member {
        EntityId id;
        Vec3 site;
    };
    std::vector<Vec3> around_;
    double height_ = 0;
    std::vector<std::vector<Member>> layers_; // the free sphere first
};

} // namespace

CrystalWaveResult run_experiment(const CrystalWave& s) {
    require(s.wavelength > 0 && s.path > 0 && s.amplitude > 0 && s.step > 0,
            "crystal wave: expected a wavelength, a path, an amplitude and a step above 0");
    const CrystalResult still = run_experiment(s.crystal);
    const double radius = 0.5 * (s.crystal.spacing + still.overlap);
    const double height = neighbours(s.crystal.lattice).back().x(); // of a layer, in spacings
    const auto layers_in = [&](double spacings) {
        return static_cast<std::size_t>(std::ceil(spacings / height));
    };
    // the half that travels backwards is reflected at the held end and follows a wavelength behind
    const std::size_t start = layers_in(0.5 * s.wavelength) + 1,
                      near = start + layers_in(s.wavelength), far = near + layers_in(s.path);

    World world = make_world(Grains::spheres);
    const auto material = world.resource<Materials>().add(s.crystal.material);
    const Layers layers(world, s.crystal, radius, material, far + start);
    const double mass = value_of<Mass>(world, layers.sphere(start)),
                 length = s.wavelength * s.crystal.spacing;
    const double speed = s.amplitude * std::sqrt(still.contact_force * still.overlap / mass);
    for (std::size_t k = 1; k < 2 * start; ++k) {
        const double x = (static_cast<double>(k) - static_cast<double>(start)) * layers.height();
        if (std::abs(x) < 0.5 * length)
            value_of<Velocity>(world, layers.sphere(k)) =
                0.5 * speed * (1 + std::cos(2 * pi * x / length)) * s.motion;
    }
    const double stiffness =
        (is_hertz(s.crystal.law) ? 1.5 : 1.0) * still.contact_force / still.overlap;
    const double dt = s.step * std::sqrt(mass / stiffness);
    Simulation sim = begin(std::move(world), {.dt = dt, .law = s.crystal.law, .unlimited = true});
    layers.move_images(sim.world());

    CrystalWaveResult r;
    Peak first, last;
    // run until the peak is a quarter of the wavelength past the far layer; every wave is faster
    // than a tenth of sqrt(k/m) spacings
    const auto limit = static_cast<std::uint64_t>(10 * (2 * s.wavelength + s.path) / s.step);
    const double quarter = 0.25 * s.wavelength / s.path;
    const auto is_past = [&] {
        const double late = static_cast<double>(r.steps) - last.time_index();
        return last.value() > 0.1 * speed &&
               late > quarter * (last.time_index() - first.time_index());
    };
    while (r.steps < limit && !is_past()) {
        sim.advance();
        layers.move_images(sim.world());
        first.add(value_of<Velocity>(sim, layers.sphere(near)).dot(s.motion));
        last.add(value_of<Velocity>(sim, layers.sphere(far)).dot(s.motion));
        ++r.steps;
    }
    if (r.steps == limit) throw SimulationError("crystal wave: the pulse does not arrive");
    r.speed = static_cast<double>(far - near) * layers.height() /
              ((last.time_index() - first.time_index()) * dt);
    r.amplitude = last.value() / (0.5 * speed);
    return r;
}

} // namespace bris
