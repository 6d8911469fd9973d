#include "systems/contact/stable_step.hpp"

#include "components/body.hpp"
#include "components/body_contacts.hpp"
#include "components/census.hpp"
#include "components/elasticity.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/over_ranks.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "systems/contact/body_matrix.hpp"
#include "systems/loads/table.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace bris {

namespace {

constexpr auto free_motion = static_cast<std::uint32_t>(Motion::free);
/// Stiffness (N/m or Pa) from which on a pair is one of two rigid boundaries, which never touch.
constexpr double rigid = 1e20;

/// A touching contact as seen by one of its bodies.
struct Touch {
    double normal, shear, rolling;        ///< tangent stiffnesses, N/m, N/m, N m/rad
    double normal_damping, shear_damping; ///< N s/m
    /// Vector (m) from the body's centre of mass to the contact point; direction of the normal.
    Vec3 arm, direction;
    bool between_free_bodies;
};

/// `arm`: m, of the couple.
Touch touch_of(const LawTraits& traits, const LawRow& law, const Elasticity& e, double inverse_mass,
               double rolling_ratio, double arm) {
    Touch t{e.normal,      e.shear, rolling_ratio * e.shear * arm * arm, 0, 0, Vec3::Zero(),
            Vec3::UnitZ(), false};
    if (!traits.dashpots || !(inverse_mass > 0)) return t;
    const double mass = 1 / inverse_mass;
    t.normal_damping = law.normal_rate * mass + law.normal_ratio * std::sqrt(e.normal * mass);
    t.shear_damping = law.shear_rate * mass + law.shear_ratio * std::sqrt(e.normal * mass);
    return t;
}

/// Parts of the rows of bodies, as near each other as rows are in space: what is kept of all bodies
/// of one at a time takes little memory.
class Windows {
public:
    explicit Windows(std::size_t rows)
        : rows_(rows), width_(std::max<std::size_t>(4096, rows / 16)) {}
    std::size_t count() const { return (rows_ + width_ - 1) / width_; }
    std::size_t of(Row r) const { return r / width_; }
    std::size_t begin(std::size_t window) const { return window * width_; }
    std::size_t end(std::size_t window) const { return std::min(rows_, begin(window + 1)); }

private:
    std::size_t rows_, width_;
};

/// The contacts of one kind: window by window, or body by body in the order of BodyContacts, so
/// that the result is always bitwise the same.
template <class Pairs>
class Touches {
public:
    explicit Touches(const World& world) : law_(traits(world.resource<ContactLaw>().law)) {
        if (!world.has<Pairs>()) return;
        index_ = &world.resource<NearIndex<Pairs>>();
        entry_ = world.column<typename Pairs::Near, NearPair>();
        force_ = world.column<typename Pairs::Near, PairForce>();
        rows_ = world.column<Pairs, PairRows>();
        position_ = world.column<Bodies, Position>();
        mass_ = world.column<Bodies, InertialMass>();
        motion_ = world.column<Bodies, MotionOf>();
        // one step later than the contact records: they differ by the motion of one step
        sphere_row_ = world.column<Listed, ListedPosition>();
        body_ = world.column<Listed, ListedBody>();
        materials_ = &world.resource<Materials>();
        if (world.table<Pairs>().template has<Worn>()) worn_ = world.column<Pairs, Worn>();
        const Table& near = world.table<typename Pairs::Near>();
        if (near.template has<PatchShare>()) share_ = near.template column<PatchShare>();
    }
    /// Sorts the contacts by the windows of rows in which their bodies lie.
    void sort(const Windows& windows) {
        if (index_ == nullptr) return;
        in_window_.resize(windows.count());
        index_->for_touching([&](Row k) {
            const std::size_t of_owner = windows.of(body_[entry_[k].owner]),
                              of_partner = windows.of(rows_[entry_[k].pair].partner_body);
            in_window_[of_owner].push_back(k);
            if (of_partner != of_owner) in_window_[of_partner].push_back(k);
        });
    }
    /// Calls visit(row of a body, touch) for both bodies of the contacts of a window.
    template <class Visit>
    void visit_window(std::size_t window, Visit&& visit) const {
        if (index_ == nullptr) return;
        for (const Row k : in_window_[window]) {
            Touch t = touch(k);
            for (const Row b : {body_[entry_[k].owner], rows_[entry_[k].pair].partner_body}) {
                t.arm = arm(b, k);
                visit(b, t);
            }
        }
    }
    /// Calls visit(row of the partner, row of the pair, touch of the partner) for all contacts.
    template <class Visit>
    void visit_partners(Visit&& visit) const {
        if (index_ == nullptr) return;
        index_->for_touching([&](Row k) {
            const Row pair = entry_[k].pair, b = rows_[pair].partner_body;
            Touch t = touch(k);
            t.arm = arm(b, k);
            visit(b, pair, t);
        });
    }
    /// Lists the contacts of marked bodies.
    void list(const World& world, const std::vector<char>& marked) {
        if (index_ != nullptr) contacts_.emplace(world, &marked);
    }
    /// Calls visit(touch) for the listed contacts of a body.
    template <class Visit>
    void visit(Row b, Visit&& visit) const {
        if (!contacts_) return;
        contacts_->visit(b, [&](Row k, bool) {
            Touch t = touch(k);
            t.arm = arm(b, k);
            visit(t);
        });
    }

private:
    Vec3 point(Row k) const { return {force_[k].px, force_[k].py, force_[k].pz}; }
    Vec3 arm(Row b, Row k) const { return point(k) - position_[b]; }
    /// Of either body, without its arm.
    Touch touch(Row k) const {
        const PairRowNumbers& pair = rows_[entry_[k].pair];
        const SphereRow& p = sphere_row_[entry_[k].owner];
        const Row owner = body_[entry_[k].owner];
        const double radius = effective_radius<Pairs>(entry_[k], sphere_row_);
        // a force beyond touch is no spring; such a pair counts as a contact of zero overlap
        Elasticity e = elasticity_of(law_, *materials_, pair.law, force_[k].overlap, radius,
                                     worn_.empty() ? Worn::never : worn_[entry_[k].pair]);
        if (!share_.empty()) e = {share_[k] * e.normal, share_[k] * e.shear, share_[k] * e.energy};
        const auto inverse_mass = [&](Row of) {
            return motion_[of] == free_motion ? 1 / mass_[of] : 0;
        };
        Touch t = touch_of(law_, law_.rows(*materials_)[pair.law], e,
                           inverse_mass(owner) + inverse_mass(pair.partner_body),
                           materials_->policy.rolling_stiffness_ratio,
                           law_.couple_arm(materials_->edge_pairs[pair.law], radius));
        // the contact point lies on the normal through the centre of the owner's sphere
        t.direction = (Vec3(p.x, p.y, p.z) - point(k)).normalized();
        t.between_free_bodies =
            motion_[owner] == free_motion && motion_[pair.partner_body] == free_motion;
        return t;
    }

    const LawTraits& law_;
    const NearIndex<Pairs>* index_ = nullptr; ///< null: the scene has no such pairs
    std::vector<std::vector<Row>> in_window_; ///< near rows
    std::optional<BodyContacts<Pairs>> contacts_;
    std::span<const NearEntry> entry_;
    std::span<const ForceRow> force_;
    std::span<const PairRowNumbers> rows_;
    std::span<const Vec3> position_;
    std::span<const double> mass_, share_, worn_;
    std::span<const std::uint32_t> motion_;
    std::span<const SphereRow> sphere_row_;
    std::span<const Row> body_;
    const Materials* materials_ = nullptr;
};

/// A contact of a body without spheres, and which it is of those that all ranks have found.
struct BoundaryTouch {
    EntityId body;
    unsigned kind; ///< of pair, in the order in which forces are summed
    PairNames names;
    Touch touch;
    friend bool operator<(const BoundaryTouch& a, const BoundaryTouch& b) {
        if (a.body != b.body) return a.body < b.body;
        return a.kind != b.kind ? a.kind < b.kind : a.names < b.names;
    }
};

/// The contacts of all kinds, and the springs of force elements.
class AllTouches {
public:
    explicit AllTouches(const World& world)
        : spheres_(world), facets_(world), planes_(world), membrane_(world), springs_(world) {}
    void sort(const Windows& windows) {
        spheres_.sort(windows);
        facets_.sort(windows);
        planes_.sort(windows);
        membrane_.sort(windows);
    }
    /// Calls visit(row, touch) for what the bodies of a window touch, and others in those contacts.
    template <class Visit>
    void visit_window(std::size_t window, Visit&& visit) const {
        spheres_.visit_window(window, visit);
        facets_.visit_window(window, visit);
        planes_.visit_window(window, visit);
        membrane_.visit_window(window, visit);
        for (const BodySpring& s : springs_.all()) visit(s.body, touch_of_spring(s));
    }
    /// Calls visit(touch) for the springs of a body.
    template <class Visit>
    void visit_springs(Row b, Visit&& visit) const {
        for (const BodySpring& s : springs_.of(b)) visit(touch_of_spring(s));
    }
    /// What the free bodies without spheres of a divided world touch, on the first rank.
    std::vector<BoundaryTouch> of_boundaries(const World& part) const {
        std::vector<BoundaryTouch> all;
        unsigned kind = 0;
        for_each_kind_of_pair([&]<class Pairs>() {
            if (part.has<Pairs>() && !std::is_same_v<Pairs, SpherePairs>)
                add_boundaries<Pairs>(part, kind, all);
            ++kind;
        });
        Ranks::gather(all);
        std::ranges::sort(all, std::less());
        return all;
    }
    /// Lists what marked bodies touch.
    void list(const World& world, const std::vector<char>& marked) {
        spheres_.list(world, marked);
        facets_.list(world, marked);
        planes_.list(world, marked);
        membrane_.list(world, marked);
    }
    /// Calls visit(touch) for all that a listed body touches.
    template <class Visit>
    void visit(Row b, Visit&& visit) const {
        spheres_.visit(b, visit);
        facets_.visit(b, visit);
        planes_.visit(b, visit);
        membrane_.visit(b, visit);
        visit_springs(b, visit);
    }

private:
    template <class Pairs>
    const Touches<Pairs>& of_kind() const {
        if constexpr (std::is_same_v<Pairs, SpherePairs>) return spheres_;
        if constexpr (std::is_same_v<Pairs, FacetPairs>) return facets_;
        if constexpr (std::is_same_v<Pairs, PlanePairs>) return planes_;
        if constexpr (std::is_same_v<Pairs, MembranePairs>) return membrane_;
    }
    template <class Pairs>
    void add_boundaries(const World& part, unsigned kind, std::vector<BoundaryTouch>& all) const {
        const auto id = part.column<Bodies, BodyId>();
        const auto motion = part.column<Bodies, MotionOf>();
        const auto names = part.column<Pairs, PairKey>();
        of_kind<Pairs>().visit_partners([&](Row b, Row pair, const Touch& touch) {
            if (motion[b] == free_motion) all.push_back({id[b], kind, names[pair], touch});
        });
    }
    static Touch touch_of_spring(const BodySpring& s) {
        return {s.stiffness, 0, 0, s.damping, 0, s.arm, s.axis, false};
    }
    Touches<SpherePairs> spheres_;
    Touches<FacetPairs> facets_;
    Touches<PlanePairs> planes_;
    Touches<MembranePairs> membrane_;
    ElementSprings springs_;
};

/// Upper bound of the largest eigenvalue of a positive matrix, from the norm of its power
/// 2^squarings: at most 0.02 % too large with 12 (6^(1/8192) = 1.0002), a quarter with 2.
double largest_eigenvalue(Mat6 m, int squarings) {
    double log_scale = 0;
    for (int k = 0; k < squarings; ++k) {
        const double norm = m.norm();
        if (!(norm > 0)) return 0;
        m /= norm;
        log_scale = 2 * (log_scale + std::log(norm));
        m = (m * m).eval();
    }
    return std::exp((log_scale + std::log(m.norm())) / (1 << squarings));
}

/// Rounding, and what largest_eigenvalue may have more than another bound.
constexpr double margin_of_bounds = 1e-3;

/// Masses and moments of inertia of bodies, including mass scaling.
class Inertias {
public:
    explicit Inertias(const Table& bodies) : mass_(bodies.column<InertialMass>()) {
        if (bodies.has<SphereInertia>()) {
            of_spheres_ = bodies.column<SphereInertia>();
        } else {
            of_clumps_ = bodies.column<InertialInertia>();
            orientation_ = bodies.column<Orientation>();
        }
    }
    double mass(Row b) const { return mass_[b]; } ///< kg
    /// Smallest principal moment of inertia, kg m2.
    double least(Row b) const {
        return of_spheres_.empty() ? of_clumps_[b].minCoeff() : of_spheres_[b];
    }
    /// Upper bound of the largest eigenvalue of M^-1 K.
    double bound(const BodyMatrix& matrix, Row b) const {
        return of_spheres_.empty() ? matrix.bound(mass_[b], turning_root(b))
                                   : matrix.bound(mass_[b], of_spheres_[b]);
    }
    /// Square root M^-1/2 of the inverse mass matrix. The eigenvalues of M^-1/2 K M^-1/2 are
    /// squares of angular frequencies.
    Mat6 inverse_root(Row b) const {
        Mat6 root = Mat6::Zero();
        root.topLeftCorner<3, 3>() = Mat3::Identity() / std::sqrt(mass_[b]);
        root.bottomRightCorner<3, 3>() = turning_root(b);
        return root;
    }

private:
    Mat3 turning_root(Row b) const {
        if (!of_spheres_.empty()) return Mat3::Identity() / std::sqrt(of_spheres_[b]);
        const Mat3 axes = orientation_[b].toRotationMatrix();
        return axes * of_clumps_[b].cwiseSqrt().cwiseInverse().asDiagonal() * axes.transpose();
    }
    std::span<const double> mass_, of_spheres_; ///< inertia of single spheres, or of clumps
    std::span<const Vec3> of_clumps_;
    std::span<const Quat> orientation_;
};

/// Stable step (s) of a damped mode, 2/omega without damping, for central differences in which the
/// dashpot's velocity is predicted from the step before.
double limit(double omega2, double rate) {
    constexpr double margin = 0.999; // at exactly 2/omega a mode grows slowly
    return omega2 > 0 ? margin * 2 / (std::sqrt(omega2 + 0.25 * rate * rate) + 0.5 * rate)
                      : std::numeric_limits<double>::infinity();
}

/// The partner moves too: (x + y)^2 <= 2 x^2 + 2 y^2.
double share_of(const Touch& t) { return t.between_free_bodies ? 2 : 1; }

struct BodyMatrices {
    BodyMatrix stiffness, damping;
    void add(const Touch& t) {
        const double share = share_of(t);
        stiffness.add(t.arm, t.direction, share * t.normal, share * t.shear, share * t.rolling);
        if (t.normal_damping != 0 || t.shear_damping != 0)
            damping.add(t.arm, t.direction, share * t.normal_damping, share * t.shear_damping, 0);
    }
};

/// Lower bounds of the stable steps (s) of wanted bodies, infinite for others.
std::vector<double> bounds_of_steps(AllTouches& touches, const Inertias& inertias,
                                    const std::vector<char>& wanted) {
    const Windows windows(wanted.size());
    touches.sort(windows);
    std::vector<double> steps(wanted.size(), std::numeric_limits<double>::infinity());
    std::vector<BodyMatrices> sums;
    for (std::size_t w = 0; w < windows.count(); ++w) {
        const std::size_t begin = windows.begin(w), end = windows.end(w);
        sums.assign(end - begin, {});
        touches.visit_window(w, [&](Row b, const Touch& t) {
            if (b >= begin && b < end && wanted[b] != 0) sums[b - begin].add(t);
        });
        for (std::size_t b = begin; b < end; ++b) {
            if (wanted[b] == 0) continue;
            const auto& [stiffness, damping] = sums[b - begin];
            const Row row = static_cast<Row>(b);
            steps[b] = limit(inertias.bound(stiffness, row), inertias.bound(damping, row));
        }
    }
    return steps;
}

/// Stable step (s) of a body, or a bound of it that is at least `enough`. `for_touches(visit)`
/// calls visit(touch) for all that the body touches.
template <class ForTouches>
double step_of(ForTouches&& for_touches, const Inertias& inertias, Row b, double enough) {
    BodyMatrices sums;
    for_touches([&](const Touch& t) { sums.add(t); });
    const Mat6 root = inertias.inverse_root(b);
    const Mat6 k = root * sums.stiffness.matrix() * root, c = root * sums.damping.matrix() * root;
    const auto with = [&](int squarings) {
        return limit(largest_eigenvalue(k, squarings), largest_eigenvalue(c, squarings));
    };
    const double rough = with(2);
    return (1 - margin_of_bounds) * rough >= enough ? rough : with(12);
}

/// The same of the free bodies without spheres of a divided world, on the first rank; elsewhere
/// infinite. Each rank has the contacts of its own grains with them.
double step_of_boundaries(const World& part, const AllTouches& touches, const Inertias& inertias,
                          double enough) {
    const std::vector<BoundaryTouch> all = touches.of_boundaries(part);
    if (!Ranks::is_first()) return std::numeric_limits<double>::infinity();
    const auto id = part.column<Bodies, BodyId>();
    const auto motion = part.column<Bodies, MotionOf>();
    for (const Row b : part.resource<Census>().boundaries) {
        if (motion[b] != free_motion) continue;
        const auto mine = std::ranges::equal_range(all, id[b], {}, &BoundaryTouch::body);
        const auto for_touches = [&](auto&& visit) {
            for (const BoundaryTouch& t : mine) visit(t.touch);
            touches.visit_springs(b, visit);
        };
        enough = std::min(enough, step_of(for_touches, inertias, b, enough));
    }
    return enough;
}

} // namespace

std::vector<BodyStiffness> body_stiffness(const World& world) {
    std::vector<BodyStiffness> all(world.table<Bodies>().size());
    AllTouches touches(world);
    touches.list(world, std::vector<char>(all.size(), 1));
    for (Row b = 0; b < all.size(); ++b)
        touches.visit(b, [&](const Touch& t) {
            all[b].translation += std::max(t.normal, t.shear);
            all[b].rotation += t.normal * t.arm.cross(t.direction).squaredNorm() +
                               t.shear * t.arm.squaredNorm() + t.rolling;
        });
    return all;
}

double stable_step(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto motion = bodies.column<MotionOf>();
    const OverRanks ranks(world);
    const Inertias inertias(bodies);
    AllTouches touches(world);
    constexpr double infinite = std::numeric_limits<double>::infinity();
    std::vector<char> wanted(bodies.size());
    for (Row b = 0; b < wanted.size(); ++b)
        wanted[b] = motion[b] == free_motion && ranks.counts(b) ? 1 : 0;
    if (ranks.is_divided())
        for (const Row b : world.resource<Census>().boundaries) wanted[b] = 0;
    const std::vector<double> bound = bounds_of_steps(touches, inertias, wanted);
    double step = infinite;
    const auto look_at = [&](auto&& is_wanted) {
        std::vector<char> marked(bound.size(), 0);
        for (Row b = 0; b < bound.size(); ++b) marked[b] = is_wanted(bound[b]) ? 1 : 0;
        if (std::ranges::find(marked, 1) == marked.end()) return;
        touches.list(world, marked);
        for (Row b = 0; b < bound.size(); ++b)
            if (marked[b] != 0)
                step = std::min(step, step_of([&](auto&& visit) { touches.visit(b, visit); },
                                              inertias, b, step));
    };
    // bodies of the least bounds first: few others can have a shorter step
    const double least = bound.empty() ? infinite : *std::ranges::min_element(bound),
                 first = 1.1 * least;
    look_at([&](double of) { return of <= first && of < infinite; });
    look_at([&](double of) { return of > first && (1 - margin_of_bounds) * of < step; });
    if (ranks.is_divided())
        step = std::min(step, step_of_boundaries(world, touches, inertias, step));
    return ranks.smallest(step);
}

double stable_step_of_first_contact(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto mass = bodies.column<InertialMass>();
    const auto radius = bodies.column<BoundingRadius>();
    const auto true_mass = bodies.column<Mass>();
    const LawTraits& law = traits(world.resource<ContactLaw>().law);
    const auto& materials = world.resource<Materials>();
    const Inertias inertias(bodies);
    const bool spheres = bodies.has<SphereInertia>();
    // fines only soften contacts, so the pairs of materials suffice
    double fastest = 0, step = std::numeric_limits<double>::infinity();
    for (const Vec3& v : bodies.column<Velocity>()) fastest = std::max(fastest, v.norm());
    for (Row b = 0; b < bodies.size(); ++b) {
        // boundaries have no mass; fixed rocks count, as they may be freed later
        if (!(true_mass[b] > 0)) continue;
        for (Row pair = 0; pair < materials.pairs_of_materials(); ++pair) {
            const LawRow& row = law.rows(materials)[pair];
            const EdgeRow& edges = materials.edge_pairs[pair];
            if (!(row.kn > 0) || row.kn >= rigid) continue; // a pair of two boundaries
            const double tip = law.wears && edges.radius > 0 ? edges.radius : radius[b],
                         overlap = law.overlap_to_expect(row, mass[b], tip, 2 * fastest);
            Elasticity e = law.elasticity(row, overlap, tip);
            if (law.wears) { // a blunt edge has a wider contact than a sharp one of that overlap
                const Elasticity blunt = elasticity_of(law, materials, pair, overlap, tip, 0);
                if (blunt.normal > e.normal) e = blunt;
            }
            const Touch t =
                touch_of(law, row, e, 1 / mass[b], materials.policy.rolling_stiffness_ratio,
                         law.couple_arm(edges, radius[b]));
            const double largest = std::max(t.normal, t.shear),
                         damping = std::max(t.normal_damping, t.shear_damping);
            // the normal of a single sphere passes through its centre
            const double turning = radius[b] * radius[b] / inertias.least(b);
            const double omega2 = largest / mass[b] + (spheres ? t.shear : largest) * turning;
            const double rate = damping / mass[b] + (spheres ? t.shear_damping : damping) * turning;
            step = std::min(step, limit(2 * omega2, 2 * rate));
        }
    }
    return step;
}

} // namespace bris
