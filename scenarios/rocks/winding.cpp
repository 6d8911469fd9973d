#include "scenarios/rocks/winding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace bris {

namespace {

constexpr int lines_a_side = 45;

/// A place where a line along z crosses the surface: outside in (1) or inside out (-1).
struct Crossing {
    double height;
    int sign;
};

/// Twice the signed area of a triangle in the plane of x and y.
double area(const Vec3& a, const Vec3& b, double x, double y) {
    return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}

/// Lines along z, evenly spread over the box of a body.
class Lines {
public:
    explicit Lines(const Polyhedron& body) : low_(body.vertices.front()), crossings_(count) {
        Vec3 high = low_;
        for (const Vec3& corner : body.vertices) {
            low_ = low_.cwiseMin(corner);
            high = high.cwiseMax(corner);
        }
        spacing_ = (high - low_) / lines_a_side;
        for (const auto& [i, j, k] : body.triangles)
            cross({body.vertices[i], body.vertices[j], body.vertices[k]});
    }

    double miscounted_share() {
        double inside = 0, miscounted = 0;
        for (auto& line : crossings_) {
            std::ranges::sort(line, {}, &Crossing::height);
            double here = 0, wrong = 0;
            int winding = 0;
            for (std::size_t k = 0; k < line.size(); ++k) {
                const double length = k > 0 ? line[k].height - line[k - 1].height : 0;
                if (winding != 0) here += length;
                if (winding != 0 && winding != 1) wrong += length;
                winding += line[k].sign;
            }
            if (winding != 0) continue; // it touches an edge
            inside += here;
            miscounted += wrong;
        }
        return inside > 0 ? miscounted / inside : 0;
    }

private:
    static constexpr std::size_t count = std::size_t{lines_a_side} * lines_a_side;

    // not in the middle of cells, because the edges of regular bodies lie there
    double x_of(int i) const { return low_.x() + (i + 0.4142) * spacing_.x(); }
    double y_of(int j) const { return low_.y() + (j + 0.7321) * spacing_.y(); }

    /// Indices of the lines between two coordinates.
    static std::pair<int, int> between(double from, double to, double low, double spacing) {
        if (!(spacing > 0)) return {0, -1};
        return {std::max(0, static_cast<int>((from - low) / spacing) - 1),
                std::min(lines_a_side - 1, static_cast<int>((to - low) / spacing))};
    }

    void cross(const std::array<Vec3, 3>& corners) {
        const auto& [a, b, c] = corners;
        const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
        const auto [first_i, last_i] = between(low.x(), high.x(), low_.x(), spacing_.x());
        const auto [first_j, last_j] = between(low.y(), high.y(), low_.y(), spacing_.y());
        for (int i = first_i; i <= last_i; ++i)
            for (int j = first_j; j <= last_j; ++j) {
                const double x = x_of(i), y = y_of(j);
                const double of_c = area(a, b, x, y), of_a = area(b, c, x, y),
                             of_b = area(c, a, x, y);
                const bool up = of_a > 0 && of_b > 0 && of_c > 0,
                           down = of_a < 0 && of_b < 0 && of_c < 0;
                if (!up && !down) continue;
                const double height =
                    (of_a * a.z() + of_b * b.z() + of_c * c.z()) / (of_a + of_b + of_c);
                crossings_[static_cast<std::size_t>(i * lines_a_side + j)].push_back(
                    {height, up ? -1 : 1}); // upwards, a line leaves through a face that faces up
            }
    }

    Vec3 low_, spacing_;
    std::vector<std::vector<Crossing>> crossings_;
};

} // namespace

double miscounted_share(const Polyhedron& polyhedron) {
    return Lines(polyhedron).miscounted_share();
}

} // namespace bris
