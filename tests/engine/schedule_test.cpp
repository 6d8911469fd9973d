#include "engine/health.hpp"
#include "engine/parallel.hpp"
#include "engine/schedule.hpp"
#include "engine/simulation.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;

namespace {

struct Cells {
    static constexpr auto name = "cells";
};
struct Others {
    static constexpr auto name = "others";
};
struct A : State<double> {
    static constexpr auto name = "a", unit = "";
};
struct B : Derived<double> {
    static constexpr auto name = "b", unit = "";
};
struct C : Derived<double> {
    static constexpr auto name = "c", unit = "";
};
struct D : State<double> {
    static constexpr auto name = "d", unit = "";
};

/// Counts calls and determines the steps in which periodic systems are due.
struct Log {
    static constexpr auto name = "log";
    unsigned step = 0;
};
struct Rare {
    static constexpr auto name = "rare";
    double value = 0;
};

void b_from_a(Rows<Cells, const A, B> cells) {
    for (Row r = cells.first(); r < cells.last(); ++r)
        cells.column<B>()[r] = 2 * cells.column<A>()[r] + 1;
}
void c_from_a(Rows<Cells, const A, C> cells) {
    for (Row r = cells.first(); r < cells.last(); ++r)
        cells.column<C>()[r] = 3 * cells.column<A>()[r] - 1;
}
void a_from_b_and_c(Rows<Cells, A, const B, const C> cells) {
    for (Row r = cells.first(); r < cells.last(); ++r)
        cells.column<A>()[r] = 0.25 * (cells.column<B>()[r] + cells.column<C>()[r]);
}
void a_from_b(Rows<Cells, A, const B> cells) {
    for (Row r = cells.first(); r < cells.last(); ++r)
        cells.column<A>()[r] = 0.5 * cells.column<B>()[r];
}
void d_from_all_b(Rows<Others, D> others, Rows<Cells, const B> cells) {
    double sum = 0;
    for (Row r = 0; r < cells.size(); ++r) sum += cells.column<B>()[r];
    for (Row r = others.first(); r < others.last(); ++r) others.column<D>()[r] += sum;
}
void shift_b(Rows<Cells, B> cells, const Rare& rare) {
    for (Row r = cells.first(); r < cells.last(); ++r) cells.column<B>()[r] += rare.value;
}
void count(Log& log) { ++log.step; }
void make_rare(Rare& rare, const Log& log) { rare.value = log.step; }
void edit(World&) {}

World world_of(Row n) {
    World world;
    Table& cells = world.table<Cells>();
    cells.add<A>();
    cells.add<B>();
    cells.add<C>();
    cells.resize(n);
    for (Row r = 0; r < n; ++r) cells.column<A>()[r] = 1.0 / (r + 1);
    Table& others = world.table<Others>();
    others.add<D>();
    others.resize(3);
    return world;
}

std::string explained(StepList steps, World& world) {
    Schedule schedule(std::move(steps));
    schedule.prepare(world);
    return schedule.explain();
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_SUITE("engine/schedule") {
    TEST_CASE("an edge connects exactly those systems that share data which one of them writes") {
        World world = world_of(4);
        const std::string text =
            explained({system("left", b_from_a), system("right", c_from_a),
                       system("join", a_from_b_and_c), system("look", d_from_all_b)},
                      world);
        CHECK(has(text, "n0 -> n2;")); // a_from_b_and_c reads what both write
        CHECK(has(text, "n1 -> n2;"));
        CHECK_FALSE(has(text, "n0 -> n1;")); // both only read A
        CHECK(has(text, "n0 -> n3;"));       // reads B
        CHECK_FALSE(has(text, "n1 -> n3;"));
        CHECK_FALSE(has(text, "n2 -> n3;")); // A is not D
    }

    TEST_CASE("an edge that is implied by others is left out") {
        World world = world_of(4);
        const std::string text = explained(
            {system("left", b_from_a), system("back", a_from_b), system("left again", b_from_a)},
            world);
        CHECK(has(text, "n0 -> n1;"));
        CHECK(has(text, "n1 -> n2;"));
        CHECK_FALSE(has(text, "n0 -> n2;"));
    }

    TEST_CASE("a system that takes the whole world runs after all systems before it and before all "
              "after it") {
        World world = world_of(4);
        const std::string text = explained(
            {system("left", b_from_a), system("edit", edit), system("back", a_from_b)}, world);
        CHECK(has(text, "n0 -> n1;"));
        CHECK(has(text, "n1 -> n2;"));
        CHECK(has(text, "everything"));
    }

    TEST_CASE(
        "a system is absent if the scene lacks a column, a table or a resource of its signature") {
        World world = world_of(4);
        world.add_resource<Log>();
        const std::string text = explained({system("left", b_from_a), system("back", a_from_b),
                                            system("rare", make_rare), system("shift", shift_b)},
                                           world);
        CHECK(has(text, "rare: absent (no rare)"));
        CHECK(has(text, "shift: absent (no rare)"));
        World bare;
        bare.table<Cells>().add<A>();
        const std::string less =
            explained({system("left", b_from_a), system("look", d_from_all_b)}, bare);
        CHECK(has(less, "left: absent (no cells.b)"));
        CHECK(has(less, "no others"));
    }

    TEST_CASE("a system is unwanted if no running system reads what it derives, and does not run") {
        World world = world_of(4);
        const StepList list{system("left", b_from_a), system("right", c_from_a),
                            system("back", a_from_b)};
        const std::string text = explained(list, world);
        CHECK(has(text, "right: unwanted"));
        CHECK_FALSE(has(text, "left: unwanted"));
        Schedule without(list);
        World fresh = world_of(4);
        without.prepare(fresh);
        without.run(fresh);
        CHECK(fresh.column<Cells, C>()[0] == 0);
    }

    TEST_CASE("a chain of derived data without a final reader is unwanted as a whole") {
        World world = world_of(4);
        const std::string text =
            explained({system("b", b_from_a), system(
                                                  "c",
                                                  +[](Rows<Cells, const B, C> cells) {
                                                      cells.column<C>()[0] = cells.column<B>()[0];
                                                  })},
                      world);
        CHECK(has(text, "b: unwanted"));
        CHECK(has(text, "c: unwanted"));
    }

    TEST_CASE("more conditional systems than the schedule can tell apart are an error") {
        World world = world_of(4);
        const System conditional =
            when([](const World&) { return true; }, system("left", b_from_a));
        CHECK_NOTHROW(Schedule(StepList(64, conditional)).prepare(world));
        CHECK_THROWS_WITH_AS(Schedule(StepList(65, conditional)).prepare(world),
                             "step list: expected at most 64 conditional systems, found 65",
                             std::logic_error);
    }

    TEST_CASE("a system that is not due does not run, nor do the systems that only feed it") {
        World world = world_of(1);
        world.add_resource<Log>();
        world.add_resource<Rare>();
        const auto every_third = +[](const World& w) { return w.resource<Log>().step % 3 == 0; };
        // only d_from_all_b reads the Derived B
        StepList list{system("b", b_from_a), when(every_third, system("look", d_from_all_b)),
                      system(
                          "count", +[](Log& log, Rows<Others, D>) { ++log.step; })};
        Schedule schedule(list);
        schedule.prepare(world);
        double expected = 0;
        for (unsigned step = 0; step < 7; ++step) {
            world.column<Cells, B>()[0] = -100; // seen only if b runs
            schedule.run(world);
            if (step % 3 == 0) expected += 3; // 2 * 1 + 1
            CHECK(world.column<Others, D>()[0] == expected);
            CHECK(world.column<Cells, B>()[0] == (step % 3 == 0 ? 3 : -100));
        }
    }

    TEST_CASE("explain() lists the systems, their reads, writes and predecessors, and those that "
              "are left out") {
        World world = world_of(4);
        const std::string text = explained(
            {system("left", b_from_a), system("back", a_from_b), system("count", count)}, world);
        CHECK(has(text, "left\n    reads  cells.a\n    writes cells.b"));
        CHECK(has(text, "back\n    reads  cells.b\n    writes cells.a\n    after  left"));
        CHECK(has(text, "count: absent (no log)"));
        CHECK(has(text, "digraph step {"));
    }

    TEST_CASE("adjacent row-local systems on one table run as one pass, which a system that reads "
              "other rows ends") {
        World world = world_of(1000);
        const StepList list{
            row_local("left", b_from_a),       row_local("right", c_from_a),
            row_local("join", a_from_b_and_c), system("look", d_from_all_b),
            row_local("left again", b_from_a), row_local("join again", a_from_b_and_c)};
        const std::string text = explained(list, world);
        CHECK(has(text, "left + right + join"));
        CHECK(has(text, "left again + join again"));
        CHECK_FALSE(has(text, "look +"));
        CHECK_FALSE(has(text, "+ look"));
        // the result equals that of the list in order, for any grain
        World in_order = world_of(1000);
        StepList plain = list;
        for (System& s : plain) s.row_local.reset();
        Schedule fused(list, {.grain = 7}), unfused(plain);
        fused.prepare(world);
        unfused.prepare(in_order);
        Threads team(3);
        for (int step = 0; step < 5; ++step) {
            team.run([&] { fused.run(world); });
            unfused.run(in_order);
        }
        CHECK(std::ranges::equal(world.column<Cells, A>(), in_order.column<Cells, A>()));
        CHECK(std::ranges::equal(world.column<Others, D>(), in_order.column<Others, D>()));
    }

    TEST_CASE("systems that raise one alarm share a pass, but not with a system that reads it") {
        World world = world_of(10);
        world.add_resource(Alarm{});
        const auto raise_for_a = +[](Rows<Cells, const A>, Alarm& alarm) { alarm.raise(); };
        const auto raise_for_b = +[](Rows<Cells, const B>, Alarm& alarm) { alarm.raise(); };
        const auto ask = +[](Rows<Cells, C> cells, const Alarm& alarm) {
            for (Row r = cells.first(); r < cells.last(); ++r)
                cells.column<C>()[r] = alarm.raised ? 1 : 0;
        };
        const std::string text =
            explained({row_local("left", b_from_a), row_local("raise", raise_for_a),
                       row_local("raise again", raise_for_b), row_local("ask", ask),
                       row_local("join", a_from_b_and_c)},
                      world);
        CHECK(has(text, "\"left + raise + raise again\""));
        CHECK(has(text, "\"ask + join\""));
    }

    TEST_CASE("a system that combines others runs in their place where nothing else runs between "
              "them, and nowhere else") {
        const StepList parts{row_local("left", b_from_a), row_local("right", c_from_a),
                             row_local("join", a_from_b_and_c)};
        const auto all_at_once = +[](Rows<Cells, A, B, C> cells) {
            b_from_a(cells);
            c_from_a(cells);
            a_from_b_and_c(cells);
            cells.column<C>()[cells.first()] = 17; // shows that this system has run
        };
        const auto with_combined = [&](std::vector<std::string> names) {
            StepList list = parts;
            list.push_back(combined(std::move(names), row_local("all at once", all_at_once)));
            return list;
        };
        const auto c_after_step = [&](const StepList& list, ScheduleSettings settings) {
            World world = world_of(10);
            Schedule schedule(list, settings);
            schedule.prepare(world);
            Threads team(1);
            team.run([&] { schedule.run(world); });
            return world.column<Cells, C>()[0];
        };
        const StepList whole = with_combined({"left", "right", "join"}),
                       fewer = with_combined({"left", "right"});
        CHECK(c_after_step(whole, {}) == 17);
        CHECK(c_after_step(whole, {.combined = false}) != 17);
        CHECK(c_after_step(whole, {.fused = false}) != 17);
        CHECK(c_after_step(fewer, {}) != 17);
        // also in place of a system between two passes
        StepList apart{row_local("left", b_from_a), system("look", d_from_all_b),
                       row_local("right", c_from_a), row_local("join", a_from_b_and_c)};
        const auto with_look = +[](Rows<Cells, A, B, C> cells, Rows<Others, D> others) {
            b_from_a(cells);
            d_from_all_b(others, cells);
            c_from_a(cells);
            a_from_b_and_c(cells);
            cells.column<C>()[0] = 18;
        };
        apart.push_back(combined({"left", "look", "right", "join"}, system("all", with_look)));
        CHECK(c_after_step(apart, {}) == 18);
        CHECK(c_after_step(apart, {.combined = false}) != 18);
        apart.back().combines.pop_back();
        CHECK(c_after_step(apart, {}) != 18);
        World world = world_of(10);
        CHECK(has(explained(whole, world), "in place of left + right + join"));
        CHECK(has(explained(fewer, world), "all at once: not exactly the systems"));
    }

    TEST_CASE("row-local systems do not share a pass if one writes another table that the next one "
              "reads") {
        World world = world_of(10);
        const auto write_others = +[](Rows<Cells, const A> cells, Rows<Others, D> others) {
            if (cells.first() == 0) others.column<D>()[0] = cells.column<A>()[0];
        };
        const auto read_others = +[](Rows<Cells, A> cells, Rows<Others, const D> others) {
            for (Row r = cells.first(); r < cells.last(); ++r)
                cells.column<A>()[r] += others.column<D>()[0];
        };
        const std::string text =
            explained({row_local("write", write_others), row_local("read", read_others)}, world);
        CHECK_FALSE(has(text, "write + read"));
        CHECK(has(text, "n0 -> n1;"));
    }

    TEST_CASE("the list, the task graph and another valid order give the same bits") {
        const StepList list{system("left", b_from_a), system("right", c_from_a),
                            system("look", d_from_all_b), system("join", a_from_b_and_c)};
        const auto run = [&](unsigned threads, ScheduleSettings settings) {
            World world = world_of(777);
            Schedule schedule(list, settings);
            schedule.prepare(world);
            Threads team(threads);
            team.run([&] {
                for (int step = 0; step < 20; ++step) schedule.run(world);
            });
            std::vector<double> all(world.column<Cells, A>().begin(),
                                    world.column<Cells, A>().end());
            all.push_back(world.column<Others, D>()[1]);
            return all;
        };
        const auto reference = run(1, {});
        CHECK(run(2, {}) == reference);
        CHECK(run(1, {.overlap = true}) == reference);
        CHECK(run(2, {.overlap = true}) == reference);
        CHECK(run(3, {.overlap = true}) == reference);
        CHECK(run(2, {.last_order = true}) == reference);
    }

    TEST_CASE("a schedule that has run as a graph can be moved and continues") {
        const StepList list{system("left", b_from_a), system("right", c_from_a),
                            system("join", a_from_b_and_c)};
        World world = world_of(50), other = world_of(50);
        Schedule plain(list);
        plain.prepare(other);
        Threads team(2);
        std::vector<Schedule> schedules;
        schedules.emplace_back(list, ScheduleSettings{.overlap = true});
        schedules[0].prepare(world);
        team.run([&] { schedules[0].run(world); });
        schedules.reserve(10); // moves the schedule in memory
        team.run([&] { schedules[0].run(world); });
        for (int k = 0; k < 2; ++k) plain.run(other);
        CHECK(std::ranges::equal(world.column<Cells, A>(), other.column<Cells, A>()));
    }
}
