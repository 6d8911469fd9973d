#pragma once

namespace bris {

// Kinds name the tables of a scene. Every boundary is a body; spheres, facets and planes belong to
// a body. A pair table holds candidates and their history; its short list holds those near now.

struct Bodies {
    static constexpr auto name = "bodies";
};
struct Spheres {
    static constexpr auto name = "spheres";
};
struct Facets {
    static constexpr auto name = "facets";
};
struct Planes {
    static constexpr auto name = "planes";
};
struct Elements {
    static constexpr auto name = "elements";
}; // of a membrane
/// Packed rows of the spheres that are on some short list, a run for each body; of single spheres
/// all, in the rows of their bodies.
struct Listed {
    static constexpr auto name = "listed";
};

struct NearSpheres {
    static constexpr auto name = "near_spheres";
};
struct NearFacets {
    static constexpr auto name = "near_facets";
};
struct NearPlanes {
    static constexpr auto name = "near_planes";
};
struct NearMembrane {
    static constexpr auto name = "near_membrane";
};

// rows_per_flag: near rows a byte of touching flags; facets are reduced in runs that cross bytes
struct SpherePairs {
    static constexpr auto name = "sphere_pairs";
    using Near = NearSpheres;
    static constexpr unsigned rows_per_flag = 8;
};
struct FacetPairs {
    static constexpr auto name = "facet_pairs";
    using Near = NearFacets;
    static constexpr unsigned rows_per_flag = 1;
};
struct PlanePairs {
    static constexpr auto name = "plane_pairs";
    using Near = NearPlanes;
    static constexpr unsigned rows_per_flag = 8;
};
struct MembranePairs {
    static constexpr auto name = "membrane_pairs";
    using Near = NearMembrane;
    static constexpr unsigned rows_per_flag = 8;
};

/// Calls visit.template operator()<Pairs>() for every kind of pair, in the order of the force sums.
template <class Visit>
void for_each_kind_of_pair(Visit&& visit) {
    visit.template operator()<SpherePairs>();
    visit.template operator()<FacetPairs>();
    visit.template operator()<PlanePairs>();
    visit.template operator()<MembranePairs>();
}

} // namespace bris
