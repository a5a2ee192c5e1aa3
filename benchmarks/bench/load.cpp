#include "load.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include <busbar/client/response_limits.hpp>
#include <busbar/types/discovery.hpp>

#include "identity.hpp"

namespace busbar::bench {

namespace {

MessageSecurityMode mode_of(const std::string& name)
{
    return name == "Sign"             ? MessageSecurityMode::Sign
           : name == "SignAndEncrypt" ? MessageSecurityMode::SignAndEncrypt
                                      : MessageSecurityMode::None;
}

std::size_t most(const std::vector<std::size_t>& counts)
{
    return counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
}

/// The same in every run.
std::vector<std::size_t> order_of(const Options& options)
{
    std::vector<std::size_t> numbers(most_values(options));
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    if (!options.is_sequential) {
        std::shuffle(numbers.begin(), numbers.end(), std::minstd_rand{1});
    }
    return numbers;
}

} // namespace

std::size_t most_values(const Options& options)
{
    return std::max({most(options.read_counts), most(options.write_counts),
                     most(options.browse_counts), options.variables, std::size_t{1}});
}

binary::DecodeLimits generous_limits()
{
    binary::DecodeLimits limits = client::response_limits;
    limits.max_array_length = 1'000'000;
    return limits;
}

Load::Load(Options options)
    : options_{std::move(options)}, numbers_{order_of(options_)}, meter_{
                                                                      options_.subscribe.server_pid}
{
    security_ = {crypto::find_policy_by_name(options_.policy), mode_of(options_.mode)};
}

channel::ChannelEnvironment Load::environment()
{
    return {.random = &random_,
            .wall_clock = &wall_clock_,
            .log = &log_,
            .validator = &validator_,
            .identity = identity_ ? &*identity_ : nullptr};
}

Result<void> Load::open(net::ClientLoop& loop, bool wants_session,
                        std::chrono::milliseconds request_timeout)
{
    client::ConnectionConfig config;
    config.request_timeout = request_timeout;
    config.session_timeout = std::max(config.session_timeout, request_timeout);
    config.channel.endpoint_url = options_.url;
    config.channel.limits.max_message_size = 64U << 20U;
    config.application_uri = "urn:busbar:bench";
    config.limits = generous_limits();
    config.wants_session = wants_session;
    if (wants_session) {
        config.channel.security = security_;
        config.channel.server_certificate = server_certificate_;
        if (!options_.user.empty()) {
            config.identity = client::NamedUser{options_.user, options_.password};
        }
    }
    const auto connected = loop.connect(std::move(config), environment());
    return connected ? loop.wait_until_ready() : connected;
}

channel::ClientChannel Load::make_channel()
{
    channel::ClientChannelConfig config;
    config.endpoint_url = options_.url;
    config.security = security_;
    config.server_certificate = server_certificate_;
    return {std::move(config), environment(), clock_now()};
}

Result<void> Load::prepare()
{
    if (security_.policy == nullptr) {
        return fail(status::Bad_SecurityPolicyRejected);
    }
    if (security_.policy->is_none()) {
        return {};
    }
    auto identity = options_.identity ? Result<channel::ApplicationIdentity>{*options_.identity}
                                      : make_identity(wall_clock_.now());
    net::ClientLoop loop;
    const auto opened = identity ? open(loop, false) : fail(identity.error());
    if (!opened) {
        return opened;
    }
    identity_ = *std::move(identity);
    GetEndpointsRequest request;
    request.endpoint_url = String{options_.url};
    const auto event = loop.call(request);
    const auto response = event ? event->response<GetEndpointsResponse>() : fail(event.error());
    if (!response) {
        return fail(response.error());
    }
    for (const EndpointDescription& endpoint : response->endpoints) {
        if (endpoint.security_mode == security_.mode &&
            endpoint.security_policy_uri.view() == security_.policy->uri) {
            const auto chain = crypto::parse_chain(endpoint.server_certificate.span());
            if (chain) {
                server_certificate_ = chain->front();
                return {};
            }
        }
    }
    return fail(status::Bad_SecurityPolicyRejected);
}

Result<std::vector<Row>> Load::run()
{
    std::vector<Row> rows;
    for (std::size_t round = 0; round < options_.rounds; ++round) {
        const std::size_t first = rows.size();
        if (const auto done = run_round(rows); !done) {
            return fail(done.error());
        }
        for (std::size_t i = first; i < rows.size(); ++i) {
            rows[i].round = round;
        }
    }
    return rows;
}

bool Load::wants(const char* load) const
{
    const std::vector<std::string>& only = options_.only;
    return only.empty() || std::find(only.begin(), only.end(), load) != only.end();
}

Result<void> Load::run_round(std::vector<Row>& rows)
{
    Result<void> done;
    const auto keep = [&](Result<Row> row) {
        if (row) {
            rows.push_back(*std::move(row));
        } else {
            done = fail(row.error());
        }
    };
    if (wants("connects") && options_.connects != 0) {
        keep(connect_load());
    }
    net::ClientLoop loop;
    if (done) {
        done = open(loop, true);
    }
    if (done && options_.is_registered) {
        done = register_nodes(loop);
    }
    const auto each = [&](const char* name, const std::vector<std::size_t>& counts, auto load) {
        for (std::size_t i = 0; wants(name) && done && i < counts.size(); ++i) {
            keep((this->*load)(loop, counts[i]));
        }
    };
    each("reads", options_.read_counts, &Load::read_load);
    each("writes", options_.write_counts, &Load::write_load);
    each("browses", options_.browse_counts, &Load::browse_load);
    each("in-flight", options_.in_flight, &Load::in_flight_load);
    loop.close();
    return done;
}

Result<std::vector<SubscribeRow>> Load::run_subscriptions()
{
    const std::vector<std::size_t>& counts = options_.subscribe.item_counts;
    std::vector<SubscribeRow> rows;
    for (std::size_t i = 0; i < options_.rounds * counts.size(); ++i) {
        net::ClientLoop loop;
        const auto opened = open(loop, true);
        auto row = opened ? subscribe(loop, options_.subscribe, counts[i % counts.size()])
                          : fail(opened.error());
        if (!row) {
            return fail(row.error());
        }
        row->round = i / counts.size();
        rows.push_back(*row);
        loop.close();
    }
    return rows;
}

} // namespace busbar::bench
