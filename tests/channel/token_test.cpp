#include <catch2/catch.hpp>

#include "channel/output_buffer.hpp"
#include "channel/token.hpp"

namespace token_test {

using namespace busbar;
using channel::detail::OutputBuffer;
using channel::detail::SequenceNumbers;

TEST_CASE("sequence numbers grow by one and wrap early",
          "[channel][sequence][unit:Security LegacySequenceNumber]")
{
    SequenceNumbers sent;
    CHECK(sent.next() == 1);
    CHECK(sent.next() == 2);
    sent.reset_to(4'294'966'271U);
    CHECK(sent.next() == 4'294'966'272U);
    CHECK(sent.next() == 1);
    SequenceNumbers received;
    CHECK(received.accept(500));
    CHECK(received.accept(501));
    CHECK_FALSE(received.accept(501));
    CHECK_FALSE(received.accept(503));
    CHECK_FALSE(received.accept(500));
    CHECK(received.accept(502));
}

TEST_CASE("a received sequence number may wrap only near the end and to below 1024",
          "[channel][sequence][unit:Security LegacySequenceNumber]")
{
    const auto after = [](std::uint32_t first, std::uint32_t second) {
        SequenceNumbers numbers;
        return numbers.accept(first) && numbers.accept(second);
    };
    CHECK(after(4'294'966'272U, 0));
    CHECK(after(4'294'966'272U, 1'023));
    CHECK_FALSE(after(4'294'966'272U, 1'024));
    CHECK_FALSE(after(4'294'966'270U, 1));
    CHECK(after(UINT32_MAX, 5));
}

TEST_CASE("an output buffer takes back what was not sent", "[channel][output]")
{
    OutputBuffer buffer;
    buffer.reserve(4)[0] = std::byte{1};
    buffer.commit(1);
    const std::size_t mark = buffer.position();
    static_cast<void>(buffer.reserve(100'000));
    buffer.commit(100'000);
    buffer.roll_back(mark);
    CHECK(buffer.output().size() == 1);
    buffer.consume(1);
    CHECK(buffer.output().empty());
    static_cast<void>(buffer.reserve(10));
    buffer.commit(10);
    buffer.consume(3);
    const std::size_t second = buffer.position();
    static_cast<void>(buffer.reserve(1'000'000));
    buffer.commit(5);
    buffer.roll_back(second);
    CHECK(buffer.output().size() == 7);
}

} // namespace token_test
