// One impact of a sphere on a sphere or a surface, compared with the closed form of Hertz or of the
// linear spring.
#include "engine/choice.hpp"
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

struct ImpactSettings {
    Impact impact;
    MaterialOptions sphere{alumina()}, partner{wall()};
    std::string target = "plane", law = "hertz_mindlin_viscous", tension = "allowed",
                history = "rescaled";
    double friction = 0.092, restitution = 0.98, angle = 20, rolling_friction = 0,
           twisting_friction = 0;
    double angular_velocity_x = 0, angular_velocity_y = 0, angular_velocity_z = 0,
           partner_angular_velocity_x = 0, partner_angular_velocity_y = 0,
           partner_angular_velocity_z = 0;

    ImpactSettings() {
        impact.radius = impact.partner_radius = 2.5e-3;
        impact.speed = 3.9;
        impact.steps_per_contact = 1000;
    }
    void describe(auto& option) {
        option("target", target, "",
               "Target that the sphere hits. edge and vertex: the shared edge of two coplanar "
               "facets and the shared vertex of four.",
               target_names);
        option("law", law, "", "Contact law.", law_choices());
        option("radius", impact.radius, "m", "Radius of the sphere.", above(0, 1e3));
        option("partner_radius", impact.partner_radius, "m", "Radius of a partner sphere.",
               above(0, 1e3));
        option("speed", impact.speed, "m/s", "Relative speed before the impact.", above(0, 1e4));
        option("angle", angle, "degrees", "Angle between relative velocity and contact normal.",
               half_open(0, 90));
        option("partner_share", impact.partner_share, "",
               "Share of the relative speed that a partner sphere has.", within(0, 1));
        option("angular_velocity_x", angular_velocity_x, "rad/s",
               "Initial angular velocity of the sphere about x, the tangential direction of its "
               "flight.",
               within(-1e7, 1e7));
        option("angular_velocity_y", angular_velocity_y, "rad/s",
               "Initial angular velocity of the sphere about y, perpendicular to the plane of its "
               "flight.",
               within(-1e7, 1e7));
        option("angular_velocity_z", angular_velocity_z, "rad/s",
               "Initial angular velocity of the sphere about z, the contact normal.",
               within(-1e7, 1e7));
        option("partner_angular_velocity_x", partner_angular_velocity_x, "rad/s",
               "Initial angular velocity of a partner sphere about x.", within(-1e7, 1e7));
        option("partner_angular_velocity_y", partner_angular_velocity_y, "rad/s",
               "Initial angular velocity of a partner sphere about y.", within(-1e7, 1e7));
        option("partner_angular_velocity_z", partner_angular_velocity_z, "rad/s",
               "Initial angular velocity of a partner sphere about z.", within(-1e7, 1e7));
        option.group("Contact");
        option("friction", friction, "", "Coulomb friction coefficient of the pair.",
               within(0, 100));
        option("restitution", restitution, "", "Coefficient of restitution of the pair.",
               within(0, 1));
        option("rolling_friction", rolling_friction, "",
               "Rolling friction coefficient of the pair. It acts in rolling laws only.",
               within(0, 100));
        option("twisting_friction", twisting_friction, "",
               "Twisting friction coefficient of the pair. It acts in rolling laws only.",
               within(0, 100));
        option(
            "tension", tension, "",
            "Policy for tension at the end of a contact. allowed: the dashpot may pull, and "
            "restitution is exact. cut: the normal force ends at zero, and restitution is higher "
            "than nominal. calibrated: the same with a stronger dashpot, and restitution is "
            "exact.",
            tension_names);
        option("shear_history", history, "",
               "Policy by which the tangential spring of a Hertz law follows its changing "
               "stiffness. rescaled: the force decreases with the stiffness and does not increase "
               "with it. incremental: the force changes by stiffness times displacement only. "
               "total: the force is stiffness times stretch.",
               shear_history_names);
        option("shear_dashpot", impact.policy.shear_dashpot, "",
               "The dashpot that follows from restitution damps the tangential spring too.");
        option("local_damping", impact.local_damping, "",
               "Coefficient of local damping, as a fraction of the unbalanced force.",
               half_open(0, 1));
        option.group("Materials");
        sphere.describe(option, "", "of the sphere");
        partner.describe(option, "partner_", "of the partner");
        option.group("Accuracy");
        option("steps_per_contact", impact.steps_per_contact, "",
               "Number of time steps in the undamped contact time.", above(1, 1e8));
        option("phase", impact.phase, "",
               "Time from the first touch to the first contact force, as a fraction of a time "
               "step.",
               half_open(0, 1));
    }
    Impact complete() const {
        Impact s = impact;
        s.target = named<Target>(target_names, target);
        s.law = law_named(law);
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

void check_options(const ImpactSettings& settings, const Common&) { check(settings.complete()); }

void run(const ImpactSettings& settings, const Common& common) {
    const Impact impact = settings.complete();
    const Summary results = results_of(impact, run_experiment(impact));
    report_results(common, results);
}

std::string explain(const ImpactSettings& settings, const Common&) {
    return explain_step(settings.complete().law, Grains::spheres);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<ImpactSettings>(argc, argv,
                                        {"impact",
                                         "One impact of a sphere on a sphere or a surface.",
                                         "a run of an impact takes only a moment"},
                                        check_options, run, explain);
}
