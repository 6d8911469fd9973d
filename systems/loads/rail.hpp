#pragma once

#include "systems/loads/element.hpp"
#include "systems/loads/rail_beam.hpp"

#include <Eigen/SparseCholesky>

#include <cstdint>
#include <memory>

namespace bris {

/// Where a tie carries a rail.
struct RailSeat {
    EntityId tie = 0;
    Vec3 point = Vec3::Zero(); ///< m, in the axes of the tie
    double along = 0;          ///< m, along the rail; set by add_rail
    std::uint32_t number = 0;  ///< index in Rails::ties; set by add_rail

    static auto fields(auto& self) {
        return std::tie(self.tie, self.point, self.along, self.number);
    }
};

/// A rail on several ties: an Euler-Bernoulli beam without mass, straight where nothing acts on it,
/// that a pad and a fastening hold to each tie, both ways. It bends in one direction. Supports that
/// only push are those of the ties: a bed, or patches.
struct Rail {
    Vec3 up = Vec3::UnitZ(),
         along = Vec3::UnitX(); ///< unit vectors: of the deflection, of the rail
    double bending = 0;         ///< N m2, E I, > 0
    double pad = 0;             ///< N/m, stiffness of each pad, > 0
    /// s, damping over stiffness of rail and pads (Kelvin and Voigt), >= 0.
    double retardation = 0;
    double weight = 0; ///< N/m, against `up`
    /// m along the rail at time 0, and N against `up`, of axles; those beyond the ends do not act.
    /// Phases may change axles, speed and RailSeat::point between steps, but nothing else.
    std::vector<double> axle_positions = {}, axle_loads = {};
    double axle_speed = 0;            ///< m/s
    std::vector<RailSeat> seats = {}; ///< two or more, in their order along the rail
    double level = 0;                 ///< m, near which the seats are; set by add_rail

    static auto fields(auto& self) {
        return std::tie(self.up, self.along, self.bending, self.pad, self.retardation, self.weight,
                        self.axle_positions, self.axle_loads, self.axle_speed, self.seats,
                        self.level);
    }
};

/// What a rail exerts on its ties (N, along `up`): the beam takes the deflections with which its
/// own forces, those of the loads and those of the pads are balanced, in a time that grows with the
/// number of ties.
class RailResponse {
public:
    explicit RailResponse(const Rail& rail);
    /// N, of weight and axles at a time (s), on ties that stay where they are.
    Eigen::VectorXd of_loads(const Rail& rail, double time) const;
    /// N, by deflections `u` of the ties (m), without loads; or N/s, by their speeds (m/s).
    Eigen::VectorXd of_ties(const Eigen::VectorXd& u) const;

private:
    using Factors = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
    /// m, of the beam above the ties, by forces and moments at its nodes.
    Eigen::VectorXd deflections(const Eigen::VectorXd& at_nodes) const;

    RailBeam beam_;
    double pad_;
    std::shared_ptr<const Factors> held_; ///< by all pads; copies of a world share them
};

/// 1 + index in Rails::ties; 0: none.
struct RailTie : State<std::uint32_t> {
    static constexpr auto name = "rail_tie", unit = "";
};
/// Sum of the forces of rails on a tie in this step.
struct RailForce : Derived<Wrench> {
    static constexpr auto name = "rail_force", unit = "N, N m";
};
/// Work of the loads on rails on the tie, and what the retardation of rails and pads has taken. The
/// energy with which loads bend the rails between the ties is counted in neither.
struct RailWork : State<double> {
    static constexpr auto name = "rail_work", unit = "J";
};
struct RailLoss : State<double> {
    static constexpr auto name = "rail_loss", unit = "J";
};

/// The rails of a scene.
struct Rails : ElementDefaults {
    static constexpr auto name = "rails", plural = "rails";
    static constexpr bool is_state = true;
    std::vector<Rail> list;
    std::vector<EntityId> ties; ///< by the number in RailTie, minus 1
    // Derived: the response of each rail; the rows of the ties in the last step, and the forces on
    // the seats of each rail in it (N, along `up`) by its loads and by the retardation
    std::vector<RailResponse> responses = {};
    std::vector<Row> rows = {};
    std::vector<Eigen::VectorXd> of_loads = {}, of_retardation = {};

    void prepare(); ///< makes what is missing of the Derived
    void save(Archive& archive) const;
    void load(const Archive& archive);

    using Acting = RailForce;
    using Work = RailWork;
    using Loss = RailLoss;
    static StepList force_systems();
    static StepList work_systems();
    static double energy(const World& world);
    static void add_springs(const World& world, std::vector<BodySpring>& springs);
};

/// Lays a rail on ties, which are free bodies of facets in a scene of clumps, in their order along
/// the rail. Throws InputError.
void add_rail(World& world, Rail rail);

} // namespace bris
