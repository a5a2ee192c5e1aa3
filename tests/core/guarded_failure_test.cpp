#include <exception>
#include <new>
#include <string>

#include <catch2/catch.hpp>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/detail/hand_over.hpp>

#include "support/failing_allocation.hpp"

namespace guarded_failure_test {

using namespace busbar;
using namespace busbar::test;

namespace {

/// Says more than a std::string keeps without memory.
class Talkative final : public std::exception {
public:
    explicit Talkative(std::string text) : text_{std::move(text)} {}

    [[nodiscard]] const char* what() const noexcept override { return text_.c_str(); }

private:
    std::string text_;
};

/// Has `work` done without memory.
template <typename Work>
void without_memory(Work work)
{
    fail_allocation(1, 1'000'000);
    {
        const Counted counted;
        work();
    }
    fail_allocation(0);
}

/// Throws, without memory for that.
void complain(const Talkative& said)
{
    const Uncounted in_test;
    throw said; // the exception's own memory is the runtime's
}

} // namespace

TEST_CASE("what an exception says is kept without memory")
{
    const Talkative said{std::string(100, 'x')};
    detail::ThrownText what;
    StatusCode status;
    without_memory([&] { status = detail::caught(what, [&] { complain(said); }); });
    CHECK(status == status::Bad_InternalError);
    CHECK(what.view() == said.what());
}

TEST_CASE("what an exception says is cut to what fits")
{
    const Talkative said{std::string(1'000, 'x')};
    detail::ThrownText what;
    CHECK(detail::caught(what, [&] { throw said; }) == status::Bad_InternalError);
    CHECK(what.view() == std::string(detail::ThrownText::max_size, 'x'));
}

TEST_CASE("undoing that throws without memory ends nothing else")
{
    const Talkative said{std::string(100, 'x')};
    bool has_gone_on = false;
    without_memory([&] {
        {
            const detail::Undo undo{[&] { complain(said); }};
        }
        has_gone_on = true;
    });
    CHECK(has_gone_on);
}

TEST_CASE("a log that throws without memory ends nothing else")
{
    class Broken final : public LogSink {
    public:
        void write(LogLevel /*level*/, std::string_view /*source*/,
                   std::string_view /*text*/) override
        {
            complain(said_);
        }

    private:
        Talkative said_{std::string(100, 'x')};
    };
    Broken log;
    detail::SafeLog safe{log};
    StatusCode status;
    without_memory([&] {
        safe.write(LogLevel::Error, "test", "text");
        status = detail::guarded(safe, "callback", [] { throw std::bad_alloc{}; });
    });
    CHECK(status == status::Bad_OutOfMemory);
}

TEST_CASE("what a Waker throws reaches neither its caller nor those who wait for it")
{
    class Broken final : public Waker {
    public:
        void wake() override { complain(said_); }

    private:
        Talkative said_{std::string(100, 'x')};
    };
    Broken broken;
    detail::WakerSlot slot{&broken};
    without_memory([&] { slot.wake(); });
    slot.set(nullptr);
    CHECK(slot.is_empty());
}

} // namespace guarded_failure_test
