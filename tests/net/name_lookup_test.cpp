#include <catch2/catch.hpp>

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <pthread.h>

#include "net/name_lookup.hpp"

namespace name_lookup_test {

using namespace busbar;
using net::detail::NameLookup;

namespace {

using Addresses = std::vector<asio::ip::address>;
using Texts = std::vector<std::string>;

/// A name server that answers about "slow" when it is told to, and about others at once.
struct Names {
    Names()
        : lookup{std::make_unique<NameLookup>(context.get_executor(), [this](const std::string& h) {
              asked.push_back(h);
              if (h == "slow") {
                  has_begun.set_value();
                  go_on.get_future().wait();
              }
              return Addresses{asio::ip::make_address(h == "slow" ? "192.0.2.1" : "192.0.2.2")};
          })}
    {
    }
    void start(const std::string& host)
    {
        lookup->start(host, [this](const Addresses& found) {
            answers.push_back(found.empty() ? "" : found[0].to_string());
        });
    }
    /// Until so many handlers have run; what threads give comes late.
    void run(std::size_t handlers)
    {
        const auto work = asio::make_work_guard(context);
        for (; handlers > 0; --handlers) {
            context.restart();
            context.run_one();
        }
    }

    asio::io_context context;
    Texts asked; // by one thread at a time
    std::promise<void> has_begun;
    std::promise<void> go_on;
    Texts answers; // an address each, or none
    std::unique_ptr<NameLookup> lookup;
};

/// No thread can be made as long as it is there: each would have a stack larger than any memory.
class NoThreads {
public:
    NoThreads()
    {
        REQUIRE(::pthread_getattr_default_np(&before_) == 0);
        pthread_attr_t huge;
        REQUIRE(::pthread_attr_init(&huge) == 0);
        REQUIRE(::pthread_attr_setstacksize(&huge, std::size_t{1} << 62U) == 0);
        REQUIRE(::pthread_setattr_default_np(&huge) == 0);
        ::pthread_attr_destroy(&huge);
    }
    NoThreads(const NoThreads&) = delete;
    NoThreads& operator=(const NoThreads&) = delete;
    ~NoThreads()
    {
        ::pthread_setattr_default_np(&before_);
        ::pthread_attr_destroy(&before_);
    }

private:
    pthread_attr_t before_{};
};

} // namespace

TEST_CASE("an answer to an older question is not taken for one to the newer", "[net][client]")
{
    Names names;
    names.start("slow");
    names.has_begun.get_future().wait();
    names.start("fast"); // waits, as one thread is enough for a name server that does not answer
    names.go_on.set_value();
    names.run(1);
    CHECK(names.answers.empty());
    names.run(1);
    CHECK(names.answers == Texts{"192.0.2.2"});
    CHECK(names.asked == Texts{"slow", "fast"});
}

TEST_CASE("a question that was put in between an older and its answer is answered by an address",
          "[net][client]")
{
    Names names;
    names.start("slow");
    names.has_begun.get_future().wait();
    names.start("192.0.2.9");
    names.run(1);
    CHECK(names.answers == Texts{"192.0.2.9"});
    names.go_on.set_value();
    names.run(1);
    CHECK(names.answers.size() == 1);
    CHECK(names.asked == Texts{"slow"}); // an address needs no thread
}

TEST_CASE("an address that is overtaken by a name is not the name's", "[net][client]")
{
    Names names;
    names.start("192.0.2.9");
    names.start("slow");
    names.has_begun.get_future().wait();
    names.run(1);
    CHECK(names.answers.empty());
    names.go_on.set_value();
    names.run(1);
    CHECK(names.answers == Texts{"192.0.2.1"});
}

TEST_CASE("nobody hears of a name that nobody wants any more", "[net][client]")
{
    Names names;
    SECTION("a name that was cancelled")
    {
        names.start("slow");
        names.lookup->cancel();
        names.go_on.set_value();
        names.run(1);
    }
    SECTION("an address whose asker has gone")
    {
        names.start("192.0.2.9");
        names.lookup.reset();
        names.run(1);
    }
    CHECK(names.answers.empty());
}

TEST_CASE("a name that no thread can be made for is as good as none, and asked for again later",
          "[net][client]")
{
    Names names;
    {
        const NoThreads none;
        names.start("fast");
        names.run(1);
        CHECK(names.answers == Texts{""});
        names.start("fast");
        names.lookup.reset(); // whose answer is on its way
        names.run(1);
    }
    CHECK(names.answers.size() == 1);
    CHECK(names.asked.empty());
    Names later;
    later.start("fast");
    later.run(1);
    CHECK(later.answers == Texts{"192.0.2.2"});
}

TEST_CASE("the system knows its own addresses, and that a name is too long to be one",
          "[net][client]")
{
    const auto own = net::detail::system_lookup("localhost");
    REQUIRE_FALSE(own.empty());
    for (const asio::ip::address& address : own) {
        CHECK(address.is_loopback());
    }
    // Longer than a label may be: no name server is asked.
    CHECK(net::detail::system_lookup(std::string(64, 'x') + ".example").empty());
}

} // namespace name_lookup_test
