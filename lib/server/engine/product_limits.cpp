#include <busbar/server/product_limits.hpp>

namespace busbar::server {

namespace {

constexpr std::uint32_t kilobyte = 1'024;

} // namespace

ServerLimits nj501_limits()
{
    ServerLimits limits;
    limits.max_sessions = 5;
    limits.max_sessions_per_user = 5;
    limits.subscriptions = nj501_subscriptions();
    return limits;
}

ServerLimits nx102_limits()
{
    return nj501_limits();
}

ServerLimits rd81opc96_limits()
{
    ServerLimits limits;
    limits.max_sessions = 15;
    limits.max_sessions_per_user = 15;
    limits.min_session_timeout = std::chrono::milliseconds{10'000};
    limits.max_session_timeout = std::chrono::milliseconds{180'000};
    limits.transport.max_message_size = 3 * kilobyte * kilobyte;
    limits.decode.max_string_length = kilobyte;
    limits.decode.max_byte_string_length = 10 * kilobyte;
    limits.decode.max_array_length = 25'001;
    OperationLimits& operations = limits.operations;
    operations.max_nodes_per_read = 25'000;
    operations.max_nodes_per_write = 3'000;
    operations.max_nodes_per_browse = 10'000;
    operations.max_nodes_per_translate_browse_paths = 10'000;
    operations.max_nodes_per_method_call = 1;
    limits.subscriptions = rd81opc96_subscriptions();
    return limits;
}

} // namespace busbar::server
