#include "scenarios/rocks/fit_spheres.hpp"

#include "engine/random.hpp"
#include "scenarios/rocks/dimensions.hpp"
#include "scenarios/rocks/surface_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace bris {
namespace {

using Vec4 = Eigen::Matrix<double, 4, 1>;
using Mat4 = Eigen::Matrix<double, 4, 4>;

/// A point at which the union is compared with the solid.
struct Sample {
    Vec3 position;
    Vec3 inwards; ///< unit vector towards the centre of a sphere that touches here
    double weight;
    /// Above 0: required depth of an interior point inside the union; below 0: required distance of
    /// an exterior point from it; 0: point on the surface. m.
    double margin;
};

/// Adds sample points along the edges between faces that are not coplanar.
void add_edges(const Polyhedron& solid, double weight, double spacing,
               std::vector<Sample>& samples) {
    std::map<std::pair<std::size_t, std::size_t>, Vec3> seen;
    std::vector<Sample> found;
    for (const auto& triangle : solid.triangles) {
        const Vec3& a = solid.vertices[triangle[0]];
        const Vec3 normal =
            (solid.vertices[triangle[1]] - a).cross(solid.vertices[triangle[2]] - a).normalized();
        for (std::size_t side = 0; side < 3; ++side) {
            const std::size_t i = triangle[side], j = triangle[(side + 1) % 3];
            const auto [other, first] = seen.try_emplace(std::minmax(i, j), normal);
            if (first || other->second.dot(normal) > 0.99) continue;
            const Vec3 inwards = -(normal + other->second).normalized();
            const Vec3 edge = solid.vertices[j] - solid.vertices[i];
            const int pieces = std::max(1, static_cast<int>(edge.norm() / spacing));
            // sharper edges have more weight because they interlock
            const double sharpness = std::sqrt(0.5 * (1 - other->second.dot(normal)));
            for (int k = 0; k <= pieces; ++k)
                found.push_back({solid.vertices[i] + edge * k / pieces, inwards, sharpness, 0.0});
        }
    }
    double total = 0;
    for (const Sample& sample : found) total += sample.weight;
    for (Sample& sample : found) {
        sample.weight *= weight / total;
        samples.push_back(sample);
    }
}

/// Increases the weight of the points that a caliper touches along the three dimensions, because
/// they determine flatness and elongation.
void weigh_extremes(const Polyhedron& solid, double size, double factor,
                    std::vector<Sample>& samples) {
    const Mat3 axes = compute_dimensions(vertex_balls(solid)).axes;
    for (int side = 0; side < 6; ++side) {
        const Vec3 direction = (side % 2 == 0 ? 1.0 : -1.0) * axes.col(side / 2);
        double support = -std::numeric_limits<double>::infinity();
        for (const Vec3& vertex : solid.vertices)
            support = std::max(support, vertex.dot(direction));
        for (Sample& sample : samples)
            if (support - sample.position.dot(direction) < 0.02 * size) sample.weight *= factor;
    }
}

std::vector<Sample> make_samples(const Polyhedron& solid, double size,
                                 const FitSettings& settings) {
    std::vector<Sample> samples;
    const std::vector<SurfacePoint> surface = surface_points(solid, 1600);
    for (const SurfacePoint& point : surface)
        samples.push_back(
            {point.position, -point.normal, 1.0 / static_cast<double>(surface.size()), 0});
    add_edges(solid, settings.corner_weight, 0.05 * size, samples);
    weigh_extremes(solid, size, settings.extreme_weight, samples);
    // interior: a void would lose mass and admit the corner of another rock
    Vec3 low = solid.vertices.front(), high = low;
    for (const Vec3& vertex : solid.vertices) {
        low = low.cwiseMin(vertex);
        high = high.cwiseMax(vertex);
    }
    const double depth = 0.08 * size;
    for (std::size_t k = 1; k <= 1200; ++k) {
        const auto part = [&](double step) {
            return std::fmod(step * static_cast<double>(k), 1.0);
        };
        const Vec3 share(part(0.8191725133961645), part(0.6710436067037893),
                         part(0.5497004779019703));
        const Vec3 point = low + share.cwiseProduct(high - low);
        if (signed_distance(solid, point) < -depth)
            samples.push_back({point, Vec3::Zero(), 1.0 / 300, 0.3 * depth});
    }
    // exterior: a sphere must not leave the solid where only a tip holds it
    for (double offset : {0.1 * size, 0.25 * size})
        for (std::size_t k = 0; k < surface.size(); k += 4) {
            const Vec3 point = surface[k].position + offset * surface[k].normal;
            if (signed_distance(solid, point) > 0.8 * offset)
                samples.push_back({point, Vec3::Zero(), 0.5 / 400, -0.6 * offset});
        }
    for (const Vec3& vertex : solid.vertices) {
        const Vec3 point = vertex + 0.15 * size * (vertex - 0.5 * (low + high)).normalized();
        if (signed_distance(solid, point) > 0.1 * size)
            samples.push_back({point, Vec3::Zero(), 0.5 / 100, -0.09 * size});
    }
    return samples;
}

/// A fitting problem: samples, limits and the misfit of a set of spheres.
class Fit {
public:
    Fit(const Polyhedron& solid, double size, const FitSettings& settings)
        : samples_(make_samples(solid, size, settings)), settings_(settings), size_(size),
          nearest_(samples_.size()), misfit_(samples_.size()), second_(samples_.size()) {}

    /// Assigns each sample to its nearest sphere and returns the sum of the loss.
    double assign(const std::vector<Ball>& balls) {
        double sum = 0;
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            const Sample& sample = samples_[k];
            double least = std::numeric_limits<double>::infinity(), next = least;
            std::size_t index = 0;
            for (std::size_t i = 0; i < balls.size(); ++i) {
                const double s = (sample.position - balls[i].centre).norm() - balls[i].radius;
                if (s < least)
                    next = least, least = s, index = i;
                else if (s < next)
                    next = s;
            }
            nearest_[k] = index;
            misfit_[k] = shifted(sample, least);
            second_[k] = shifted(sample, next);
            sum += loss(k, misfit_[k]);
        }
        return sum;
    }

    /// Makes one damped Gauss-Newton step of every sphere towards its own samples, after `assign`.
    void step(std::vector<Ball>& balls) const {
        std::vector<Mat4> normal(balls.size(), Mat4::Zero());
        std::vector<Vec4> right(balls.size(), Vec4::Zero());
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            const double s = misfit_[k];
            if (s == 0) continue;
            const std::size_t i = nearest_[k];
            const Vec3 arm = samples_[k].position - balls[i].centre;
            const double weight = samples_[k].weight * (s < 0 ? settings_.bulge_weight : 1.0) *
                                  std::pow(std::abs(s) / size_ + 1e-3, settings_.exponent - 2);
            const double distance = std::max(arm.norm(), 1e-12 * size_);
            const Vec4 gradient(-arm[0] / distance, -arm[1] / distance, -arm[2] / distance, -1);
            normal[i] += weight * gradient * gradient.transpose();
            right[i] -= weight * s * gradient;
        }
        for (std::size_t i = 0; i < balls.size(); ++i) {
            const double damping = 0.02 * normal[i].trace() + 1e-14;
            normal[i].diagonal().array() += damping;
            Vec4 move = normal[i].ldlt().solve(right[i]);
            const double limit = 0.05 * size_;
            if (move.norm() > limit) move *= limit / move.norm();
            balls[i].centre += move.head<3>();
            balls[i].radius = std::clamp(balls[i].radius + move[3], settings_.min_radius * size_,
                                         settings_.max_radius * size_);
        }
    }

    /// Makes `steps` steps; leaves the best spheres found and returns their loss.
    double descend(std::vector<Ball>& balls, int steps) {
        std::vector<Ball> best = balls;
        double least = assign(balls);
        for (int k = 0; k < steps; ++k) {
            step(balls);
            const double now = assign(balls);
            if (now < least) least = now, best = balls;
        }
        balls = best;
        return least;
    }

    /// Moves the sphere that contributes least (or the one of this rank) to where the fit is worst.
    void relocate(std::vector<Ball>& balls, std::size_t rank) {
        assign(balls);
        std::vector<std::pair<double, std::size_t>> missed(balls.size());
        for (std::size_t i = 0; i < balls.size(); ++i) missed[i] = {0.0, i};
        std::size_t worst = 0;
        double greatest = -1;
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            missed[nearest_[k]].first += loss(k, second_[k]) - loss(k, misfit_[k]);
            // without the weight: a single corner sample must be able to attract a sphere
            const double here = std::abs(misfit_[k]) * (misfit_[k] > 0 ? 1.0 : 0.5);
            if (here > greatest && samples_[k].margin == 0) greatest = here, worst = k;
        }
        std::sort(missed.begin(), missed.end());
        const double radius = settings_.min_radius * size_;
        const Sample& sample = samples_[worst];
        balls[missed[rank % missed.size()].second] = {
            sample.position + 1.2 * radius * sample.inwards, radius};
    }

    /// Spheres that touch surface points from inside; each point is as far as possible from the
    /// previous ones.
    std::vector<Ball> spread(Random& random) const {
        const auto surface = static_cast<std::size_t>(std::count_if(
            samples_.begin(), samples_.end(), [](const Sample& s) { return s.margin == 0; }));
        std::vector<double> gap(surface, std::numeric_limits<double>::infinity());
        std::vector<Ball> balls;
        auto next = static_cast<std::size_t>(random.uniform() * static_cast<double>(surface));
        const double radius = 1.5 * settings_.min_radius * size_;
        while (balls.size() < settings_.spheres) {
            const Sample& chosen = samples_[next];
            balls.push_back({chosen.position + radius * chosen.inwards, radius});
            for (std::size_t k = 0; k < surface; ++k)
                gap[k] = std::min(gap[k], (samples_[k].position - chosen.position).squaredNorm());
            next = static_cast<std::size_t>(std::max_element(gap.begin(), gap.end()) - gap.begin());
        }
        return balls;
    }

private:
    /// An interior sample counts only while it is not covered, an exterior one only while it is.
    static double shifted(const Sample& sample, double distance) {
        if (sample.margin > 0) return std::max(0.0, distance + sample.margin);
        if (sample.margin < 0) return std::min(0.0, distance + sample.margin);
        return distance;
    }
    double loss(std::size_t k, double misfit) const {
        return samples_[k].weight * (misfit < 0 ? settings_.bulge_weight : 1.0) *
               std::pow(std::abs(misfit) / size_, settings_.exponent);
    }

    std::vector<Sample> samples_;
    FitSettings settings_;
    double size_;
    std::vector<std::size_t> nearest_;
    std::vector<double> misfit_, second_;
};

/// Relative errors of volume and principal moments.
Vec4 mismatch(const MassProperties& target, const Mat3& axes, std::span<const Ball> balls) {
    const MassProperties found = union_properties(balls, 400);
    const Mat3 turned = axes.transpose() * (found.inertia - target.inertia) * axes;
    Vec4 result;
    result << found.volume / target.volume - 1, turned.diagonal() * 3 / target.inertia.trace();
    return result;
}

/// Spheres with a length added to every radius and their centres stretched along each axis.
std::vector<Ball> deformed(std::span<const Ball> balls, const Vec3& centre, const Mat3& axes,
                           const Vec4& change, double size) {
    std::vector<Ball> result;
    const Vec3 stretch = Vec3::Ones() + change.tail<3>();
    for (const Ball& ball : balls) {
        const Vec3 local = axes.transpose() * (ball.centre - centre);
        result.push_back(
            {centre + axes * local.cwiseProduct(stretch), ball.radius + change[0] * size});
    }
    return result;
}

} // namespace

std::vector<Ball> fit_spheres(const Polyhedron& polyhedron, double size,
                              const FitSettings& settings, std::uint64_t seed,
                              std::vector<Ball> start) {
    Random random(seed, 7);
    Fit fit(polyhedron, size, settings);
    std::vector<Ball> best = start.empty() ? fit.spread(random) : std::move(start);
    double least = fit.descend(best, 60);
    std::size_t rank = 0;
    for (int round = 0; round < settings.rounds; ++round) {
        std::vector<Ball> trial = best;
        fit.relocate(trial, rank);
        const double found = fit.descend(trial, 12);
        if (found < least) {
            least = found, best = std::move(trial), rank = 0;
        } else {
            rank = (rank + 1) % 8; // the next candidate, from the same spheres
        }
    }
    fit.descend(best, 100);
    return best;
}

void match_moments(const Polyhedron& polyhedron, std::vector<Ball>& balls) {
    const MassProperties target = mass_properties(polyhedron);
    const Mat3 axes = principal_axes(target.inertia).axes;
    const double size = std::cbrt(target.volume);
    std::vector<Ball> matched = balls;
    for (int round = 0; round < 8; ++round) {
        // the centre first, because the stretches cannot correct its offset
        const Vec3 offset = target.centre - union_properties(matched, 400).centre;
        for (Ball& ball : matched) ball.centre += offset;
        const Vec4 now = mismatch(target, axes, matched);
        if (now.cwiseAbs().maxCoeff() < 1e-5) break;
        Mat4 slope;
        constexpr double probe = 2e-3;
        for (int k = 0; k < 4; ++k) {
            const auto moved = deformed(matched, target.centre, axes, probe * Vec4::Unit(k), size);
            slope.col(k) = (mismatch(target, axes, moved) - now) / probe;
        }
        const Vec4 change = slope.fullPivLu().solve(-now);
        if (!(change.cwiseAbs().maxCoeff() < 0.2)) break;
        matched = deformed(matched, target.centre, axes, change, size);
    }
    if (mismatch(target, axes, matched).cwiseAbs().maxCoeff() < 1e-4) {
        balls = std::move(matched);
        return;
    }
    const MassProperties found = union_properties(balls);
    const double factor = std::cbrt(target.volume / found.volume);
    for (Ball& ball : balls)
        ball = {target.centre + factor * (ball.centre - found.centre), factor * ball.radius};
}

} // namespace bris
