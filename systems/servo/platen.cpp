#include "systems/servo/platen.hpp"

#include "systems/servo/membrane.hpp"

#include <algorithm>

namespace bris {

void Platen::save(Archive& archive) const {
    const std::array<double, 7> numbers{controlled ? 1.0 : 0.0, speed, target_pressure, largest_step,
                                        pressure,               gain,  contact_stiffness};
    archive.put("platen/settings", std::span<const double>(numbers));
}

void Platen::load(const Archive& archive) {
    const auto numbers = archive.get<double>("platen/settings");
    controlled = numbers.at(0) != 0;
    speed = numbers.at(1);
    target_pressure = numbers.at(2);
    largest_step = numbers.at(3);
    pressure = numbers.at(4);
    gain = numbers.at(5);
    contact_stiffness = numbers.at(6);
}

double polygon_area(std::span<const double> radius) {
    const std::size_t n = radius.size();
    const double angle = 2 * pi / static_cast<double>(n);
    double area = 0;
    for (std::size_t s = 0; s < n; ++s)
        area += 0.5 * radius[s] * exposed_width(radius[s], radius[(s + n - 1) % n], radius[(s + 1) % n], angle);
    return area;
}

void steer_platen(Rows<Planes, const HostRow> planes, Rows<Bodies, const Force, DriveVelocity> bodies,
                  Platen& platen, const Membrane& membrane, const NearIndex<PlanePairs>& index,
                  const Clock& clock) {
    const Row host = planes.column<HostRow>()[platen.plane];
    double area = 0;
    for (std::size_t ring = 0; ring < membrane.rings; ++ring)
        area += polygon_area({&membrane.radius[ring * membrane.sectors], membrane.sectors}) / membrane.rings;
    const double push = bodies.column<Force>()[host].z(); // the grains push the platen up
    platen.pressure = push / area;
    double speed = platen.speed;
    if (platen.controlled) {
        double stiffness = platen.contact_stiffness;
        for (Row k = index.incident_first[host]; k < index.incident_first[host + 1]; ++k)
            if (index.touches(index.incident[k])) stiffness += platen.contact_stiffness;
        const double wanted = platen.gain * (platen.target_pressure * area - push) / stiffness;
        speed = std::clamp(wanted, -platen.largest_step, platen.largest_step) / clock.dt;
    }
    bodies.column<DriveVelocity>()[host] = Vec3(0, 0, -speed);
}

} // namespace bris
