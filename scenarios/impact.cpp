// One impact of a sphere on a sphere or a surface: what comes out of it, beside Hertz's or the
// linear closed form.
#include "engine/errors.hpp"
#include "engine/scenario.hpp"
#include "engine/summary.hpp"
#include "scenarios/verification/names.hpp"

namespace {

using namespace bris;

constexpr double degree = pi / 180;

Material alumina() { // Chung and Ooi (2011), test 4
    Material m;
    m.name = "sphere";
    m.density = 4000;
    m.young_modulus = 3.8e11;
    m.poisson_ratio = 0.23;
    m.normal_stiffness = 2e7;
    m.shear_stiffness = 1.6e7;
    return m;
}

Material wall() {
    Material m = alumina();
    m.name = "partner";
    m.young_modulus = m.normal_stiffness = m.shear_stiffness = 1e30;
    return m;
}

struct Shot {
    Impact impact;
    MaterialOptions sphere{alumina()}, partner{wall()};
    std::string target = "plane", law = "hertz_mindlin_viscous", tension = "allowed",
                history = "rescaled";
    double friction = 0.092, restitution = 0.98, angle = 20, rolling_friction = 0,
           twisting_friction = 0;
    double angular_velocity_x = 0, angular_velocity_y = 0, angular_velocity_z = 0,
           partner_angular_velocity_x = 0, partner_angular_velocity_y = 0,
           partner_angular_velocity_z = 0;

    Shot() {
        impact.radius = impact.partner_radius = 2.5e-3;
        impact.speed = 3.9;
        impact.steps_per_contact = 1000;
    }
    void describe(auto& option) {
        option("target", target, "", "edge and vertex: where coplanar facets meet", target_names);
        option("law", law, "", "of contact", law_names);
        option("radius", impact.radius, "m", "of the sphere", above(0));
        option("partner_radius", impact.partner_radius, "m", "of a partner sphere", above(0));
        option("speed", impact.speed, "m/s", "relative", above(0));
        option("angle", angle, "degrees", "between velocity and normal",
               Range{.low = 0, .high = 90, .high_accepted = false});
        option("partner_share", impact.partner_share, "", "of the speed that a partner sphere has",
               within(0, 1));
        option("angular_velocity_x", angular_velocity_x, "rad/s",
               "of the sphere; it flies along x, z is normal");
        option("angular_velocity_y", angular_velocity_y, "rad/s", "likewise");
        option("angular_velocity_z", angular_velocity_z, "rad/s", "likewise");
        option("partner_angular_velocity_x", partner_angular_velocity_x, "rad/s",
               "of a partner sphere");
        option("partner_angular_velocity_y", partner_angular_velocity_y, "rad/s", "likewise");
        option("partner_angular_velocity_z", partner_angular_velocity_z, "rad/s", "likewise");
        option.group("contact");
        option("friction", friction, "", "Coulomb coefficient of the pair", at_least(0));
        option("restitution", restitution, "", "of the pair", within(0, 1));
        option("rolling_friction", rolling_friction, "", "of the pair; rolling laws", at_least(0));
        option("twisting_friction", twisting_friction, "", "of the pair; rolling laws",
               at_least(0));
        option("tension", tension, "", "whether a dashpot may pull at the end", tension_names);
        option("shear_history", history, "",
               "how the tangential spring follows its stiffness; Hertz", shear_history_names);
        option("shear_dashpot", impact.policy.shear_dashpot, "",
               "restitution damps the tangential spring too");
        option("local_damping", impact.local_damping, "", "fraction of force",
               Range{.low = 0, .high = 1, .high_accepted = false});
        option.group("materials");
        sphere.describe(option, "", "of the sphere");
        partner.describe(option, "partner_", "of the partner");
        option.group("accuracy");
        option("steps_per_contact", impact.steps_per_contact, "",
               "time steps in the undamped contact time", above(1));
        option("phase", impact.phase, "", "of a step, from the first touch to the first force",
               Range{.low = 0, .high = 1, .high_accepted = false});
    }
    Impact complete() const {
        Impact s = impact;
        s.target = named<Target>(target_names, target);
        s.law = named<LawName>(law_names, law);
        s.policy.tension = named<Tension>(tension_names, tension);
        s.policy.shear_history = named<ShearHistory>(shear_history_names, history);
        s.angle = angle * degree;
        s.angular_velocity = Vec3(angular_velocity_x, angular_velocity_y, angular_velocity_z);
        s.partner_angular_velocity = Vec3(partner_angular_velocity_x, partner_angular_velocity_y,
                                          partner_angular_velocity_z);
        s.material = sphere.material;
        s.partner_material = partner.material;
        for (Material* m : {&s.material, &s.partner_material}) {
            m->friction = friction;
            m->restitution = restitution;
            m->rolling_friction = rolling_friction;
            m->twisting_friction = twisting_friction;
        }
        return s;
    }
};

Summary results_of(const Impact& s, const ImpactResult& r) {
    const NormalContact exact = normal_contact(s);
    Summary t;
    t.add("largest_overlap_m", r.largest_overlap);
    t.add("undamped_largest_overlap_m", exact.largest_overlap());
    t.add("largest_normal_force_N", r.largest_force);
    t.add("undamped_largest_normal_force_N", exact.largest_force());
    t.add("contact_time_s", r.contact_time);
    t.add("undamped_contact_time_s", exact.time());
    t.add("normal_restitution", r.normal_restitution);
    t.add("tangential_restitution", r.tangential_restitution);
    t.add("angular_velocity_x_rad_per_s", r.angular_velocity.x());
    t.add("angular_velocity_y_rad_per_s", r.angular_velocity.y());
    t.add("angular_velocity_z_rad_per_s", r.angular_velocity.z());
    t.add("slip_before_m_per_s", r.slip_before);
    t.add("slip_after_m_per_s", r.slip);
    t.add("rebound_angle_degrees", r.rebound_angle / degree);
    t.add("energy_before_J", r.energy_before);
    t.add("energy_change", r.energy_change);
    t.add("friction_work_J", r.friction_work);
    t.add("viscous_work_J", r.viscous_work);
    t.add("rolling_work_J", r.rolling_work);
    t.add("energy_budget_error", r.energy_budget_error);
    t.add("largest_friction_over_normal_force", r.friction_ratio);
    if (s.target == Target::sphere) {
        t.add("partner_angular_velocity_x_rad_per_s", r.partner_angular_velocity.x());
        t.add("partner_angular_velocity_y_rad_per_s", r.partner_angular_velocity.y());
        t.add("partner_angular_velocity_z_rad_per_s", r.partner_angular_velocity.z());
        t.add("momentum_change", r.momentum_change);
        t.add("angular_momentum_change", r.angular_momentum_change);
    }
    t.add("steps", r.steps);
    return t;
}

void run(const Shot& settings, const Common& common) {
    const Impact impact = settings.complete();
    const Summary results = results_of(impact, run_experiment(impact));
    report_results(common, results);
}

std::string explain(const Shot& settings, const Common&) {
    return explain_step(settings.complete().law, Grains::spheres);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Shot>(
        argc, argv,
        {"impact", "one impact of a sphere on a sphere or a surface", "an impact takes a moment"},
        run, explain);
}
