#include "systems/fusion/contact_network.hpp"

#include "components/body.hpp"
#include "components/body_contacts.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"

#include <span>
#include <tuple>

namespace bris {

namespace {

/// A touching contact of a body.
struct Contact {
    Row partner;
    Vec3 point, normal;
    double kn, ks; ///< N/m; ks is 0 if the contact slips
};

/// All touching contacts of one kind of pair.
template <class Pairs>
class ContactsOf {
public:
    explicit ContactsOf(const World& world)
        : laws_(world.resource<Materials>().linear_pairs), contacts_(world) {
        if (!world.has<Pairs>()) return;
        near_ = world.column<typename Pairs::Near, NearPair>();
        force_ = world.column<typename Pairs::Near, PairForce>();
        rows_ = world.column<Pairs, PairRows>();
        sphere_row_ = world.column<Listed, ListedPosition>();
        body_ = world.column<Listed, ListedBody>();
    }
    /// Calls visit(contact) in an order that does not depend on the rows.
    template <class Visit>
    void visit(Row body, Visit&& visit) const {
        contacts_.visit(body, [&](Row k, bool as_partner) {
            const ForceRow& f = force_[k];
            const SphereRow& sphere = sphere_row_[near_[k].owner];
            const LawRow& law = laws_[near_[k].law];
            Contact c{as_partner ? body_[near_[k].owner] : rows_[near_[k].pair].partner_body,
                      Vec3(f.px, f.py, f.pz), Vec3::Zero(), law.kn, law.ks};
            c.normal = (Vec3(sphere.x, sphere.y, sphere.z) - c.point).normalized();
            const double slip = (Vec3(f.fx, f.fy, f.fz) - f.normal_force * c.normal).norm();
            if (slip >= 0.99 * law.friction * f.normal_force) c.ks = 0;
            visit(c);
        });
    }

private:
    std::span<const LawRow> laws_;
    BodyContacts<Pairs> contacts_;
    std::span<const NearEntry> near_;
    std::span<const ForceRow> force_;
    std::span<const PairRowNumbers> rows_;
    std::span<const SphereRow> sphere_row_;
    std::span<const Row> body_;
};

} // namespace

std::vector<Joint> joints_of(const World& world, std::vector<Row>& bodies, Others others) {
    const std::tuple kinds{ContactsOf<SpherePairs>(world), ContactsOf<FacetPairs>(world),
                           ContactsOf<PlanePairs>(world), ContactsOf<MembranePairs>(world)};
    const auto motion = world.column<Bodies, MotionOf>();
    const auto position = world.column<Bodies, Position>();
    constexpr std::uint32_t not_yet = that_stays - 1;
    std::vector<std::uint32_t> number(position.size(), not_yet);
    for (std::uint32_t i = 0; i < bodies.size(); ++i) number[bodies[i]] = i;
    std::vector<Joint> joints;
    for (std::uint32_t i = 0; i < bodies.size(); ++i) {
        const Row body = bodies[i];
        const auto reach = [&](const Contact& c) {
            std::uint32_t& other = number[c.partner];
            if (motion[c.partner] != static_cast<std::uint32_t>(Motion::free) ||
                (other == not_yet && others == Others::stay)) {
                other = that_stays;
            } else if (other == not_yet) {
                other = static_cast<std::uint32_t>(bodies.size());
                bodies.push_back(c.partner);
            }
            if (other < i || other == that_stays)
                joints.push_back({i, other, c.point - position[body], c.point - position[c.partner],
                                  c.normal, c.kn, c.ks});
        };
        std::apply([&](const auto&... kind) { (kind.visit(body, reach), ...); }, kinds);
    }
    return joints;
}

} // namespace bris
