#include "connection.hpp"

#include <atomic>
#include <csignal>
#include <memory>

#include "credentials.hpp"
#include "logs.hpp"

namespace busbar::tool {

namespace {

// The one that a signal ends.
std::atomic<net::BlockingClient*> interruptible{nullptr};

std::atomic<bool> has_interrupt{false};
std::atomic<bool> has_hangup{false};

void on_interrupt(int signal)
{
    has_interrupt = true;
    has_hangup = has_hangup || signal == SIGHUP;
    if (net::BlockingClient* client = interruptible.load()) {
        client->interrupt();
    }
}

void take_interrupt(net::BlockingClient& client)
{
    interruptible = &client;
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
}

void release_interrupt()
{
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    interruptible = nullptr;
}

Duration seconds(double count)
{
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double>{count});
}

} // namespace

Connection::Connection(Context& context, Endurance endurance)
    : context_{&context}, log_{context.options.is_verbose}, credentials_{context, log_},
      key_log_{open_key_log(context, log_)}, environment_{.random = &random_,
                                                          .wall_clock = &wall_clock_,
                                                          .log = &log_,
                                                          .validator = &credentials_,
                                                          .identity = credentials_.identity(),
                                                          .key_log = key_log_.get()},
      user_{user_of(context)}
{
    context.options.url = complete_url(context.options.url);
    connect(endurance);
}

void Connection::close()
{
    release_interrupt();
    if (client_ && !is_closed_) {
        is_closed_ = true;
        // Of single nodes only the end of the connection was told.
        if (const std::string refusal = own_refusal(); !refusal.empty() && !has_told_refusal_) {
            context_->warn("refused", refused_by_us({}, {}, refusal).reason);
        }
        client_->close();
    }
}

bool Connection::is_interrupted() const
{
    return has_interrupt;
}

void Connection::end_at_hangup()
{
    if (std::signal(SIGHUP, on_interrupt) == SIG_IGN) {
        std::signal(SIGHUP, SIG_IGN);
    }
}

bool Connection::is_hung_up() const
{
    return has_hangup;
}

Types Connection::types_of(const std::vector<DataValue>& values,
                           const std::vector<NodeId>& variables)
{
    std::vector<Variant> structures;
    std::vector<NodeId> owners;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i].value.type() == BuiltInType::ExtensionObject) {
            structures.push_back(values[i].value);
            owners.push_back(i < variables.size() ? variables[i] : NodeId{});
        }
    }
    const auto is_done = std::make_shared<bool>(structures.empty());
    if (!*is_done) {
        types_->learn_values(std::move(structures), std::move(owners),
                             [is_done] { *is_done = true; });
    }
    wait_until([&is_done] { return *is_done; });
    return types_->types();
}

Types Connection::types_of(const std::vector<NodeId>& data_types)
{
    const auto is_done = std::make_shared<bool>(false);
    types_->learn(data_types, [is_done] { *is_done = true; });
    wait_until([&is_done] { return *is_done; });
    return types_->types();
}

void Connection::wait_until(const std::function<bool()>& is_done)
{
    if (!client_->run_until(is_done)) {
        throw Interrupted{};
    }
}

void Connection::connect(Endurance endurance)
{
    const Options& options = context_->options;
    for (bool is_first = true;; is_first = false) {
        client_ = std::make_unique<net::BlockingClient>(config(endurance), environment_);
        take_interrupt(*client_);
        const auto connected = client_->connect(seconds(options.timeout));
        if (connected) {
            types_.emplace(client(), client::TypeCacheLimits{}, &client::parse_type_dictionary);
            warn_of_insecurity();
            return;
        }
        release_interrupt(); // the user may be asked now
        if (!credentials_.has_refused()) {
            fail_to_connect(connected.error());
        }
        if (!is_first || !credentials_.reconsider()) {
            throw credentials_.failure();
        }
    }
}

client::ClientConfig Connection::config(Endurance endurance)
{
    const Options& options = context_->options;
    client::ClientConfig config;
    config.endpoint_url = options.url;
    config.security.policies = options.policies;
    config.security.min_mode =
        options.mode == "Sign" ? MessageSecurityMode::Sign : MessageSecurityMode::SignAndEncrypt;
    config.security.allows_none = options.is_insecure;
    config.identity = user_;
    config.application_uri = credentials_.application_uri();
    config.application_name = "busbar";
    config.session_name = "busbar";
    config.request_timeout = seconds(options.timeout);
    config.connect_timeout = seconds(options.timeout);
    // Arrays may be as long as a message has room for.
    config.decode.max_array_length = config.transport.max_message_size;
    config.decode.max_string_length = config.transport.max_message_size;
    config.decode.max_byte_string_length = config.transport.max_message_size;
    config.reconnect.is_enabled = endurance == Endurance::Lasting;
    return config;
}

void Connection::warn_of_insecurity()
{
    const EndpointDescription* endpoint = client().endpoint();
    if (endpoint != nullptr && endpoint->security_mode == MessageSecurityMode::None) {
        context_->warn("insecure", "no encryption, and the server is not authenticated");
    }
}

void Connection::fail_to_connect(StatusCode status) const
{
    const std::string& url = context_->options.url;
    // These have a help of their own.
    const bool has_help = name(status).starts_with("Bad_Certificate") ||
                          status == status::Bad_SecurityPolicyRejected ||
                          status == status::Bad_IdentityTokenRejected;
    if (const std::string refusal = log_.refusal_with(status); !has_help && !refusal.empty()) {
        has_told_refusal_ = true;
        throw refused_by_us(status, url, refusal);
    }
    if (context_->options.user == "setup" && exit_of(status) == Exit::Refused) {
        throw Failure{status, url,
                      "the code is wrong, or the setup is over, even if it was interrupted at its "
                      "end: log in as the administrator that it made, --user NAME"};
    }
    if (status == status::Bad_SecurityChecksFailed) {
        throw Failure{status, url,
                      "most likely the server does not know our certificate: have its "
                      "administrator trust it; it lies in " +
                          credentials_.own_file()};
    }
    if (status != status::Bad_RequestInterrupted) {
        throw connect_failure(status, url, log_.why_unconnected());
    }
    throw Interrupted{};
}

std::string Connection::own_refusal() const
{
    return log_.refusal_with(client_->client().last_error());
}

void Connection::fail_with(StatusCode status, const std::string& what) const
{
    if (status == status::Bad_RequestInterrupted) {
        throw Interrupted{};
    }
    const bool is_lost = status == status::Bad_SecureChannelClosed ||
                         status == status::Bad_ConnectionClosed ||
                         status == status::Bad_ServerNotConnected;
    if (const std::string refusal = own_refusal(); is_lost && !refusal.empty()) {
        has_told_refusal_ = true;
        throw refused_by_us(client_->client().last_error(), what, refusal);
    }
    throw Failure{status, what};
}

} // namespace busbar::tool
