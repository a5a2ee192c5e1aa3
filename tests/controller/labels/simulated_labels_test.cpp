#include <catch2/catch.hpp>

#include "label_bench.hpp"
#include "support/allocation_count.hpp"

namespace simulated_labels_test {

// How requests are served at the ends of scans.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

const std::string four_words = "A : INT; B : INT; C : INT; D : INT;";

std::vector<std::byte> words(std::initializer_list<std::int16_t> values)
{
    std::vector<std::byte> bytes;
    for (const std::int16_t value : values) {
        const auto one = wire(value);
        bytes.insert(bytes.end(), one.begin(), one.end());
    }
    return bytes;
}

} // namespace

TEST_CASE("a request is answered at the end of the next scan, with the scan's time")
{
    LabelBench bench{program_of("I : INT;")};
    auto request = bench.to_read({"I"});
    request->id = 42;
    bench.variable<std::int16_t>("I") = 7;
    bench.labels->start(std::move(request));
    CHECK(bench.answer() == nullptr);
    bench.variable<std::int16_t>("I") = 8;
    bench.scan();
    const auto answer = bench.answer();
    REQUIRE(answer != nullptr);
    CHECK(answer->id == 42);
    CHECK(answer->status == LabelStatus::Done);
    CHECK(answer->bytes == wire(std::int16_t{8}));
    CHECK(answer->time == DateTime{bench.scans});
    CHECK(answer->scans == 1);
}

TEST_CASE("requests are served in their order")
{
    LabelBench bench{program_of("I : INT;")};
    auto first = bench.to_write({"I"}, words({1}));
    auto between = bench.to_read({"I"});
    auto last = bench.to_write({"I"}, words({2}));
    bench.labels->start(std::move(first));
    bench.labels->start(std::move(between));
    bench.labels->start(std::move(last));
    bench.scan();
    CHECK(bench.answer()->kind == LabelRequest::Kind::Write);
    CHECK(bench.answer()->bytes == words({1}));
    CHECK(bench.answer()->status == LabelStatus::Done);
    CHECK(bench.variable<std::int16_t>("I") == 2);
}

TEST_CASE("an access without places is done, and of one moment")
{
    LabelBench bench{program_of("I : INT;")};
    const auto answer = bench.serve(bench.to_read({}));
    CHECK(answer->status == LabelStatus::Done);
    CHECK(answer->scans == 1);
}

TEST_CASE("without an access unit a whole request is of one scan")
{
    LabelBench bench{program_of("A : ARRAY [0..199] OF DINT;")};
    std::vector<std::string> names;
    for (int i = 0; i < 200; ++i) {
        names.push_back("A[" + std::to_string(i) + "]");
    }
    const auto answer = bench.serve(bench.to_read(names));
    CHECK(answer->status == LabelStatus::Done);
    CHECK(answer->scans == 1);
}

TEST_CASE("a Read of more points than the access unit has values of several scans")
{
    LabelBench bench{program_of(four_words), {.access_unit = 2}};
    auto request = bench.to_read({"A", "B", "C", "D"});
    bench.labels->start(std::move(request));
    const auto set_all = [&](std::int16_t value) {
        for (const char* const name : {"A", "B", "C", "D"}) {
            bench.variable<std::int16_t>(name) = value;
        }
    };
    set_all(1);
    bench.scan();
    CHECK(bench.answer() == nullptr);
    set_all(2);
    bench.scan();
    const auto answer = bench.answer();
    REQUIRE(answer != nullptr);
    CHECK(answer->bytes == words({1, 1, 2, 2}));
    CHECK(answer->scans == 2);
    CHECK(answer->time == DateTime{bench.scans});
}

TEST_CASE("a Write of more points than the access unit is seen half done by the program")
{
    LabelBench bench{program_of(four_words), {.access_unit = 3}};
    auto request = bench.to_write({"A", "B", "C", "D"}, words({1, 2, 3, 4}));
    bench.labels->start(std::move(request));
    bench.scan();
    CHECK(bench.answer() == nullptr);
    CHECK(bench.variable<std::int16_t>("C") == 3);
    CHECK(bench.variable<std::int16_t>("D") == 0);
    bench.scan();
    CHECK(bench.answer()->scans == 2);
    CHECK(bench.variable<std::int16_t>("D") == 4);
}

TEST_CASE("the access unit is for all requests of a scan, and divides no value")
{
    LabelBench bench{program_of("S : STRING[20]; X : BOOL; Y : BOOL; Z : LREAL;"),
                     {.access_unit = 2}};
    const auto scans_to_answer = [&] {
        int scans = 0;
        while (bench.book.answers.empty()) {
            bench.scan();
            ++scans;
        }
        return std::pair{scans, bench.answer()->scans};
    };
    auto two_bits = bench.to_read({"X", "Y"});
    auto text = bench.to_read({"S"});
    auto mixed = bench.to_read({"X", "Z", "Y"});
    bench.labels->start(std::move(two_bits));
    bench.labels->start(std::move(text));
    bench.labels->start(std::move(mixed));
    CHECK(scans_to_answer() == std::pair{1, 1U});
    CHECK(scans_to_answer() == std::pair{1, 1U});
    CHECK(scans_to_answer() == std::pair{3, 3U});
}

TEST_CASE("a request with one wrong place is refused as a whole")
{
    LabelBench bench{program_of("A : INT; B : INT;")};
    const auto status_of = [&](auto&& spoil) {
        auto request = bench.to_write({"A", "B"}, words({5, 6}));
        spoil(*request);
        return bench.serve(std::move(request))->status;
    };
    CHECK(status_of([](LabelRequest& r) { r.places[1].address += 5; }) == LabelStatus::Mismatch);
    CHECK(status_of([](LabelRequest& r) { r.places[1].address = 0; }) == LabelStatus::Mismatch);
    CHECK(status_of([](LabelRequest& r) { r.places[1].size = 1; }) == LabelStatus::Mismatch);
    CHECK(status_of([](LabelRequest& r) { r.places[1].offset = 3; }) == LabelStatus::Mismatch);
    CHECK(status_of([](LabelRequest& r) { r.places[1].offset = UINT32_MAX; }) ==
          LabelStatus::Mismatch);
    CHECK(status_of([](LabelRequest& r) { r.bytes.clear(); }) == LabelStatus::Mismatch);
    CHECK(bench.variable<std::int16_t>("A") == 0);
    CHECK(status_of([](LabelRequest&) {}) == LabelStatus::Done);
    CHECK(bench.variable<std::int16_t>("A") == 5);
}

TEST_CASE("more requests than may wait are answered at once")
{
    LabelBench bench{program_of("A : INT;"), {.max_waiting = 2}};
    const auto labels = bench.resolve(std::vector<std::string>{"A"});
    const auto start = [&] {
        bench.labels->start(LabelBench::request(LabelRequest::Kind::Read, labels));
    };
    start();
    start();
    CHECK(bench.book.answers.empty());
    start();
    CHECK(bench.answer()->status == LabelStatus::TooManyOperations);
    bench.scan();
    CHECK(bench.answer()->status == LabelStatus::Done);
    CHECK(bench.answer()->status == LabelStatus::Done);
    start();
    CHECK(bench.answer() == nullptr);
    bench.scan();
    CHECK(bench.answer()->status == LabelStatus::Done);
}

TEST_CASE("what waits for a listener that is taken away is dropped and not done")
{
    LabelBench bench{program_of("A : INT;")};
    auto write = bench.to_write({"A"}, words({5}));
    bench.labels->start(std::move(write));
    bench.labels->attach(nullptr);
    AnswerBook other;
    bench.labels->attach(&other);
    bench.scan();
    CHECK(bench.book.answers.empty());
    CHECK(other.answers.empty());
    CHECK(bench.variable<std::int16_t>("A") == 0);
    // It does not count as waiting either.
    bench.labels->attach(&bench.book);
    CHECK(bench.write("A", words({6})) == LabelStatus::Done);
}

TEST_CASE("requests and labels may end with some of them waiting")
{
    LabelBench bench{program_of("A : INT;"), {.access_unit = 1}};
    auto first = bench.to_read({"A", "A"});
    auto second = bench.to_read({"A"});
    bench.labels->start(std::move(first));
    bench.scan();
    bench.labels->start(std::move(second));
    bench.labels.reset();
    CHECK(bench.book.answers.empty());
}

TEST_CASE("without communication, or at the PLC's end, all requests answer that")
{
    const auto fault = GENERATE(LabelStatus::NoCommunication, LabelStatus::Shutdown);
    LabelBench bench{program_of("A : INT;")};
    auto write = bench.to_write({"A"}, words({5}));
    auto read = bench.to_read({"A"});
    bench.labels->fail_with(fault);
    CHECK(bench.serve(std::move(write))->status == fault);
    CHECK(bench.serve(std::move(read))->status == fault);
    CHECK(bench.variable<std::int16_t>("A") == 0);
    auto names = std::make_unique<LabelRequest>();
    names->kind = LabelRequest::Kind::Resolve;
    names->names = {"A"};
    CHECK(bench.serve(std::move(names))->status == fault);
    bench.labels->fail_with(LabelStatus::Done);
    CHECK(bench.write("A", words({5})) == LabelStatus::Done);
}

TEST_CASE("a PLC that is halted answers what waits and what comes, until it scans again")
{
    LabelBench bench{program_of("A : INT;")};
    const auto labels = bench.resolve(std::vector<std::string>{"A"});
    const auto start = [&] {
        bench.labels->start(LabelBench::request(LabelRequest::Kind::Read, labels));
    };
    start();
    bench.labels->halt(DateTime{99});
    auto answer = bench.answer();
    CHECK(answer->status == LabelStatus::NoCommunication);
    CHECK(answer->time == DateTime{99});
    start();
    CHECK(bench.answer()->status == LabelStatus::NoCommunication);
    bench.scan();
    start();
    bench.scan();
    CHECK(bench.answer()->status == LabelStatus::Done);
}

TEST_CASE("the end of a scan neither allocates nor frees, whatever it has to do")
{
    LabelBench bench{program_of(four_words), {.access_unit = 3}};
    // Asked for before, so that one scan meets all of it.
    auto sample = bench.to_sample({"A", "C"});
    auto read = bench.to_read({"A", "B", "C", "D"});
    auto write = bench.to_write({"A", "B"}, words({1, 2}));
    auto names = std::make_unique<LabelRequest>();
    names->kind = LabelRequest::Kind::Resolve;
    names->names = {"A", "None"};
    bench.labels->start(std::move(sample));
    bench.labels->start(std::move(read));
    bench.labels->start(std::move(write));
    bench.labels->start(std::move(names));
    const auto calls_in_scans = [&](int scans) {
        const std::size_t before = busbar::test::calls_of_thread();
        for (int i = 0; i < scans; ++i) {
            bench.scan();
        }
        return busbar::test::calls_of_thread() - before;
    };
    CHECK(calls_in_scans(6) == 0);
    CHECK(bench.book.answers.size() == 4);
    bench.book.answers.clear();
    // A change, with values that stay, and sampling that ends with it.
    REQUIRE(bench.labels->replace_program(program_of(four_words)));
    auto after = std::make_unique<LabelRequest>();
    after->kind = LabelRequest::Kind::Resolve;
    bench.labels->start(std::move(after)); // nobody but the PLC has the old program now
    CHECK(calls_in_scans(1) == 0);
    bench.book.answers.clear();
    // What waits is dropped with its listener, and sampling ends.
    CHECK(bench.sample({"A", "B"}) == LabelStatus::Done);
    auto dropped = bench.to_read({"A", "B"});
    bench.labels->start(std::move(dropped));
    bench.labels->attach(nullptr);
    CHECK(calls_in_scans(1) == 0);
}

} // namespace simulated_labels_test
