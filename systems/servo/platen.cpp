#include "systems/servo/platen.hpp"

#include "systems/servo/membrane.hpp"

#include <algorithm>

namespace bris {

void steer_platen(Rows<Planes, const HostRow> planes, Rows<Bodies, const Force, DriveVelocity> bodies,
                  Rows<Elements, const ElementRadius> elements, Platen& platen, const Membrane& membrane,
                  const NearIndex<PlanePairs>& index, const Clock& clock) {
    const Row host = planes.column<HostRow>()[platen.plane];
    const double* radius = elements.column<ElementRadius>();
    double area = 0;
    for (std::size_t ring = 0; ring < membrane.rings; ++ring)
        area += polygon_area({radius + ring * membrane.sectors, membrane.sectors}) / membrane.rings;
    const double push = bodies.column<Force>()[host].z(); // the grains push the platen up
    platen.pressure = push / area;
    Vec3& drive = bodies.column<DriveVelocity>()[host];
    double speed = platen.speed;
    if (platen.controlled) {
        double stiffness = platen.contact_stiffness;
        for (Row k = index.incident_first[host]; k < index.incident_first[host + 1]; ++k)
            if (index.touches(index.incident[k])) stiffness += platen.contact_stiffness;
        const ServoMotion servo{platen.stiffness, platen.damping, platen.largest_step, clock.dt};
        speed = servo.next(-drive.z(), platen.target_pressure * area - push, stiffness);
    }
    drive = Vec3(0, 0, -speed);
}

} // namespace bris
