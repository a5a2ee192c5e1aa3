#include "live_world.hpp"

#include <atomic>
#include <charconv>
#include <csignal>

namespace busbar::tool {

namespace {

std::atomic<bool> is_ended{false};

void end(int /*signal*/)
{
    is_ended = true;
}

} // namespace

LiveWorld::LiveWorld()
{
    is_ended = false;
    std::signal(SIGINT, end);
    std::signal(SIGTERM, end);
}

LiveWorld::~LiveWorld()
{
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

bool LiveWorld::is_interrupted()
{
    return is_ended;
}

std::string LiveWorld::open(const std::string& address)
{
    const std::size_t colon = address.rfind(':');
    const std::string host =
        colon == std::string::npos || colon == 0 ? "127.0.0.1" : address.substr(0, colon);
    const std::string_view port =
        std::string_view{address}.substr(colon == std::string::npos ? 0 : colon + 1);
    const bool is_v6 = host.size() > 2 && host.front() == '[' && host.back() == ']';
    std::uint16_t number = 0;
    const auto read = std::from_chars(port.data(), port.data() + port.size(), number);
    if (port.empty() || read.ec != std::errc{} || read.ptr != port.data() + port.size()) {
        throw Failure{Exit::Usage,
                      "found \"" + address + "\"; expected [ADDRESS:]PORT, as 0.0.0.0:4841"};
    }
    auto url = world_.open(is_v6 ? host.substr(1, host.size() - 2) : host, number);
    if (!url) {
        throw Failure{Exit::Failed, address + ": " + world_.log().last(1)};
    }
    return *std::move(url);
}

} // namespace busbar::tool
