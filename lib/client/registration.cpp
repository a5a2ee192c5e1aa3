#include <busbar/client/registration.hpp>

#include <algorithm>
#include <optional>
#include <utility>

#include <busbar/core/text.hpp>

#include "deadline_heap.hpp"
#include "reconnect.hpp"

namespace busbar::client {

namespace {

/// The answer to GetEndpoints is the longest one of a discovery server.
constexpr std::uint32_t max_message_size = 1U << 20U;
/// Part 4, 7.13.2.
constexpr std::size_t mdns_name_limit = 64;
/// More than two connections and two requests can take.
constexpr Duration attempt_limit = std::chrono::minutes{1};

ReconnectPolicy retries(const RegistrationSettings& settings)
{
    ReconnectPolicy policy;
    policy.first = settings.first_retry;
    policy.longest = settings.interval; // Part 4, 5.5.5.1
    return policy;
}

} // namespace

ClientConfig registration_client(std::string discovery_url, SecurityWishes security,
                                 std::string application_uri, bool has_identity)
{
    ClientConfig config;
    config.endpoint_url = std::move(discovery_url);
    config.asks_for_endpoints = has_identity || !security.allows_none;
    config.security = std::move(security);
    config.application_uri = std::move(application_uri);
    config.wants_session = false;
    config.reconnect.is_enabled = false; // the Registration decides when
    config.transport.max_message_size = max_message_size;
    return config;
}

struct Registration::Impl {
    enum class Phase : std::uint8_t { Idle, Waiting, Attempting, Stopped };

    Impl(Client& c, OnceLog& l, crypto::Random& r, RegistrationSettings s)
        : client{&c}, log{&l}, random{&r}, settings{std::move(s)}, back_off{retries(settings)}
    {
    }

    void start_again(TimePoint now);
    void attempt(TimePoint now);
    void on_client(ClientState state, StatusCode why);
    void send();
    void answered(StatusCode status);
    void attempt_ended(StatusCode why, TimePoint now);
    void stop(TimePoint now);
    void end_farewell(TimePoint now);
    void end_stop(TimePoint now);
    [[nodiscard]] RegisteredServer description() const;
    [[nodiscard]] RegisterServer2Request extended_request() const;
    void tell_configuration_results(const Array<StatusCode>& results);
    void tell(StatusCode status);

    Client* client;
    OnceLog* log;
    crypto::Random* random;
    RegistrationSettings settings;
    detail::BackOff back_off;

    Phase phase{Phase::Idle};
    /// The time of the next attempt, or the end of the present one.
    TimePoint next_at{no_deadline};
    bool is_registered{false};
    StatusCode last_result;
    /// The discovery server may have us in its list.
    bool may_be_known{false};
    /// It does not know RegisterServer2; tried again after a failure, since it may have been
    /// restarted.
    bool is_old{false};

    /// The request of the present attempt.
    std::optional<RequestId> request;
    std::optional<StatusCode> result;

    bool is_stopping{false};
    /// Registers again once the present stop is over.
    bool starts_again{false};
    bool has_tried_farewell{false};
    TimePoint stop_by{no_deadline};
};

void Registration::Impl::start_again(TimePoint now)
{
    if (phase != Phase::Stopped) {
        starts_again = is_stopping;
        return;
    }
    is_stopping = false;
    may_be_known = false;
    stop_by = no_deadline;
    attempt(now);
}

void Registration::Impl::attempt(TimePoint now)
{
    phase = Phase::Attempting;
    next_at = detail::deadline_after(now, attempt_limit);
    result.reset();
    has_tried_farewell = is_stopping;
    client->connect(now);
}

void Registration::Impl::on_client(ClientState state, StatusCode why)
{
    if (phase != Phase::Attempting) {
        return;
    }
    if (state == ClientState::Ready) {
        send();
    } else if (state == ClientState::Closed) {
        attempt_ended(why, client->now());
    }
}

RegisteredServer Registration::Impl::description() const
{
    RegisteredServer server = settings.server;
    server.is_online = !is_stopping;
    return server;
}

RegisterServer2Request Registration::Impl::extended_request() const
{
    MdnsDiscoveryConfiguration mdns = settings.mdns;
    if (mdns.server_capabilities.empty()) {
        mdns.server_capabilities = Array<String>{String{"NA"}};
    }
    RegisterServer2Request sent;
    sent.server = description();
    sent.discovery_configuration.push_back(ExtensionObject::from(std::move(mdns)));
    return sent;
}

/// Its answer may never arrive: from now on the discovery server may know us.
void Registration::Impl::send()
{
    may_be_known = may_be_known || !is_stopping;
    if (is_old) {
        RegisterServerRequest sent;
        sent.server = description();
        request = client->call<RegisterServerResponse>(
            std::move(sent), [this](const Result<RegisterServerResponse>& response) {
                answered(response ? StatusCode{} : response.error());
            });
        return;
    }
    request = client->call<RegisterServer2Response>(
        extended_request(), [this](const Result<RegisterServer2Response>& response) {
            if (response) {
                tell_configuration_results(response->configuration_results);
            }
            answered(response ? StatusCode{} : response.error());
        });
}

void Registration::Impl::answered(StatusCode status)
{
    request.reset();
    if (status.code() == status::Bad_ServiceUnsupported && !is_old) { // Part 4, 5.5.6.1
        is_old = true;
        send();
        return;
    }
    if (status.code() != status::Bad_ConnectionClosed &&
        status.code() != status::Bad_SecureChannelClosed) {
        result = status;
        client->close(client->now());
    } // otherwise the Client is about to report why
}

void Registration::Impl::attempt_ended(StatusCode why, TimePoint now)
{
    if (request) {
        client->cancel(*std::exchange(request, std::nullopt));
    }
    const StatusCode lost = why.is_bad() ? why : StatusCode{status::Bad_ConnectionClosed};
    const StatusCode status = result.value_or(lost);
    if (is_stopping) {
        tell(status);
        end_farewell(now);
        return;
    }
    if (status.is_bad()) {
        // Some close the channel for an unknown service.
        is_old = !is_old && !result && why.code() == status::Bad_ServiceUnsupported;
    }
    tell(status);
    is_registered = !status.is_bad();
    last_result = status;
    phase = Phase::Waiting;
    if (is_registered) {
        back_off.reset();
    }
    next_at =
        detail::deadline_after(now, is_registered ? settings.interval : back_off.next(*random));
}

void Registration::Impl::end_farewell(TimePoint now)
{
    if (!has_tried_farewell) {
        attempt(now);
        return;
    }
    end_stop(now);
}

void Registration::Impl::end_stop(TimePoint now)
{
    is_registered = false;
    phase = Phase::Stopped;
    if (std::exchange(starts_again, false)) {
        start_again(now);
    }
}

void Registration::Impl::stop(TimePoint now)
{
    starts_again = false;
    if (std::exchange(is_stopping, true) || phase == Phase::Stopped) {
        return;
    }
    stop_by = detail::deadline_after(now, settings.farewell);
    if (!may_be_known) {
        client->close(now);
        phase = Phase::Stopped;
    } else if (phase == Phase::Waiting) {
        attempt(now);
    } else if (client->state() == ClientState::Ready) {
        // The answer of the present attempt does not matter any more.
        if (request) {
            client->cancel(*request);
        }
        has_tried_farewell = true;
        send();
    } else {
        // A request that is not sent yet becomes the unregistration; after a sent one another
        // attempt does.
        has_tried_farewell =
            client->state() != ClientState::Closing && client->state() != ClientState::Closed;
    }
}

void Registration::Impl::tell_configuration_results(const Array<StatusCode>& results)
{
    if (!results.empty() && results[0].is_bad()) {
        log->write(LogLevel::Info, "discovery",
                   "the discovery server does not announce the server by mDNS: " +
                       std::string{name(results[0])});
    }
}

void Registration::Impl::tell(StatusCode status)
{
    if (status.is_bad() == is_registered) { // a change
        log->forget();
    }
    const std::string uri = printable(settings.server.server_uri.view());
    if (status.is_bad()) {
        log->write(LogLevel::Warning, "discovery",
                   uri +
                       (is_stopping ? " is not taken back from the discovery server: "
                                    : " is not registered, will try again: ") +
                       std::string{name(status)});
    } else {
        log->write(LogLevel::Info, "discovery",
                   uri + (is_stopping ? " is taken back from the discovery server"
                                      : " is registered with the discovery server"));
    }
}

Result<void> Registration::check(const RegistrationSettings& settings)
{
    const RegisteredServer& server = settings.server;
    const auto is_empty = [](const String& text) { return text.empty(); };
    if (server.server_uri.empty()) {
        return fail(status::Bad_ServerUriInvalid);
    }
    if (std::ranges::all_of(server.server_names, is_empty, &LocalizedText::text)) {
        return fail(status::Bad_ServerNameMissing);
    }
    if (std::ranges::all_of(server.discovery_urls, is_empty)) {
        return fail(status::Bad_DiscoveryUrlMissing);
    }
    if (server.server_type == ApplicationType::Client ||
        settings.mdns.mdns_server_name.size() >= mdns_name_limit) {
        return fail(status::Bad_InvalidArgument);
    }
    if (settings.interval < min_registration_interval ||
        settings.interval > max_registration_interval) {
        return fail(status::Bad_OutOfRange);
    }
    return {};
}

Registration::Registration(Client& client, OnceLog& log, crypto::Random& random,
                           RegistrationSettings settings)
    : impl_{std::make_unique<Impl>(client, log, random, std::move(settings))}
{
    client.on_state(
        [impl = impl_.get()](ClientState state, StatusCode why) { impl->on_client(state, why); });
}

Registration::~Registration()
{
    impl_->client->on_state(nullptr);
    if (impl_->request) {
        impl_->client->cancel(*impl_->request);
    }
}

void Registration::start(TimePoint now)
{
    if (impl_->phase == Impl::Phase::Idle) {
        impl_->attempt(now);
    }
}

void Registration::start_again(TimePoint now)
{
    impl_->start_again(now);
}

void Registration::stop(TimePoint now)
{
    impl_->stop(now);
}

bool Registration::is_stopped() const
{
    return impl_->phase == Impl::Phase::Stopped;
}

bool Registration::is_registered() const
{
    return impl_->is_registered;
}

StatusCode Registration::last_result() const
{
    return impl_->last_result;
}

TimePoint Registration::next_deadline() const
{
    return is_stopped() ? no_deadline : std::min(impl_->next_at, impl_->stop_by);
}

void Registration::handle_deadline(TimePoint now)
{
    Impl& impl = *impl_;
    if (impl.phase == Impl::Phase::Attempting && now >= impl.stop_by) {
        impl.has_tried_farewell = true;
        impl.tell(status::Bad_Timeout);
        impl.client->close(now);
        impl.end_stop(now);
    } else if (impl.phase == Impl::Phase::Attempting && now >= impl.next_at) {
        impl.next_at = no_deadline;
        impl.result = status::Bad_Timeout;
        impl.client->close(now);
    } else if (impl.phase == Impl::Phase::Waiting && now >= impl.next_at) {
        impl.attempt(now);
    }
}

} // namespace busbar::client
