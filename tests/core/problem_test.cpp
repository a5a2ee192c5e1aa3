#include <catch2/catch.hpp>

#include <busbar/core/named_fields.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/refusal.hpp>

namespace problem_test {

using namespace busbar;

TEST_CASE("a problem is one line with place, text and a status that says more")
{
    CHECK(text(Problem{.where = "endpoint_url", .text = "is empty"}) == "endpoint_url: is empty");
    CHECK(text(Problem{.text = "is empty"}) == "is empty");
    CHECK(text(Problem{.where = "endpoint_url"}) == "endpoint_url");
    CHECK(text(Problem{status::Bad_OutOfMemory, "image", "is too large"}) ==
          "image: is too large (Bad_OutOfMemory)");
    CHECK(text(Problem{status::Bad_OutOfMemory, {}, {}}) == "(Bad_OutOfMemory)");
}

TEST_CASE("what was misconfigured is an error of a Configured")
{
    const Configured<int> wrong = misconfigured("port", "found 0");
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().status == status::Bad_ConfigurationError);
    CHECK(wrong.error().where == "port");
    CHECK(wrong.error().text == "found 0");
    const Configured<int> missing = misconfigured("file", "is not there", status::Bad_NotFound);
    CHECK(missing.error().status == status::Bad_NotFound);
}

TEST_CASE("a problem of a refusal has all that the refusal has")
{
    const Refusal refusal{status::Bad_CertificateUriInvalid,
                          "own certificate",
                          "it names urn:b and not urn:a",
                          "Part 6, 6.2.2",
                          "Make a new one",
                          "CN=Line 3",
                          "01AB"};
    const Problem problem = problem_of(refusal);
    CHECK(problem.status == status::Bad_CertificateUriInvalid);
    CHECK(text(problem) == "own certificate: it names urn:b and not urn:a (CN=Line 3, 01AB), "
                           "Part 6, 6.2.2. Make a new one (Bad_CertificateUriInvalid)");
    CHECK(text(problem_of({status::Bad_Timeout, "handshake", {}, {}, {}})) ==
          "handshake (Bad_Timeout)");
}

namespace {

struct Named {
    [[no_unique_address]] NamedFields named_fields{};
    int* a{nullptr};
    int* b{nullptr};
};

template <typename T>
concept FilledByPosition = requires(int* p) { T{p, p}; };
template <typename T>
concept FilledByPositionBehindBraces = requires(int* p) { T{{}, p, p}; };
template <typename T>
concept FilledByName = requires(int* p) { T{.b = p}; };

static_assert(FilledByName<Named>);
static_assert(!FilledByPosition<Named>);
static_assert(!FilledByPositionBehindBraces<Named>);
static_assert(sizeof(Named) == 2 * sizeof(int*));

} // namespace

} // namespace problem_test
