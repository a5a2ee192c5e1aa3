#include <busbar/server/server.hpp>

#include <algorithm>
#include <string>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/model/nodeset_types.hpp>

#include "config_check.hpp"
#include "server/diagnostics/server_object.hpp"
#include "server/event/namespace_nodes.hpp"
#include "server/session/session_services.hpp"
#include "server/subscription/sampler.hpp"
#include "server/users/user_policies.hpp"
#include "server_impl.hpp"

namespace busbar::server {

namespace {

/// Without memory an immediate retry would not help.
constexpr std::chrono::milliseconds retry_pause{50};

} // namespace

std::vector<EndpointConfig> secure_endpoints()
{
    const auto* policy = crypto::find_policy_by_name("Basic256Sha256");
    std::vector<EndpointConfig> endpoints(2);
    endpoints[0].security = {policy, MessageSecurityMode::SignAndEncrypt};
    endpoints[1].security = {policy, MessageSecurityMode::Sign};
    return endpoints;
}

Configured<Server> Server::create(ModuleTable modules, ServerConfig config,
                                  const ServerEnvironment& environment,
                                  model::AddressSpace address_space)
{
    if (auto checked = check_config(config, environment); !checked) {
        if (environment.log != nullptr) {
            environment.log->write(LogLevel::Error, "server", text(checked.error()));
        }
        return Unexpected{std::move(checked).error()};
    }
    detail::warn_of_deprecated_policies(config, *environment.log);
    // Part 5, 6.3.2: index 1 is the server's own namespace.
    const auto own = address_space.add_namespace(config.application_uri);
    if (!own) {
        const Problem problem{own.error(), "application_uri",
                              "there is no room for one more namespace"};
        environment.log->write(LogLevel::Error, "server", text(problem));
        return Unexpected{problem};
    }
    auto impl =
        std::make_unique<Impl>(std::move(config), environment, std::move(address_space), *own);
    detail::list_modelling_rules(impl->address_space);
    impl->add(modules);
    if (auto complete = impl->check_modules(impl->config); !complete) {
        environment.log->write(LogLevel::Error, "server", text(complete.error()));
        return Unexpected{std::move(complete).error()};
    }
    impl->claim();
    return Server{std::move(impl)};
}

Server::Server(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;

const ServerConfig& Server::config() const
{
    return impl_->config;
}

const Conformance& Server::conformance() const
{
    return impl_->conformance;
}

model::AddressSpace& Server::address_space()
{
    return impl_->address_space;
}

binary::TypeRegistry& Server::types()
{
    return impl_->types;
}

Result<void> Server::describe_namespace(std::uint16_t index, const NamespaceMetadata& metadata)
{
    model::AddressSpace& space = impl_->address_space;
    if (index >= space.namespace_count()) {
        return fail(status::Bad_NotFound);
    }
    if (metadata.default_role_permissions) {
        space.set_namespace_permissions(index, *metadata.default_role_permissions);
    }
    if (metadata.default_access_restrictions) {
        space.set_namespace_restrictions(index, *metadata.default_access_restrictions);
    }
    const auto object = detail::find_or_add_namespace(space, impl_->own_namespace, index);
    if (!object) {
        return fail(object.error());
    }
    detail::set_metadata(space, *object, metadata);
    detail::show_defaults(space, *object, index);
    return {};
}

void describe_models(Server& server, std::span<const model::NodeSetModel> models)
{
    model::AddressSpace& space = server.address_space();
    const auto own = space.namespace_index(server.config().application_uri);
    for (const model::NodeSetModel& model : models) {
        const auto index = space.namespace_index(model.uri);
        const auto object = index && own ? detail::find_or_add_namespace(space, *own, *index)
                                         : fail(status::Bad_NotFound);
        if (object) {
            NamespaceMetadata metadata;
            metadata.version = model.version;
            metadata.publication_date =
                parse_date_time(model.publication_date).value_or(DateTime{});
            detail::set_version(space, *object, metadata);
            detail::show_defaults(space, *object, *index);
        }
    }
}

std::uint32_t Server::add_source(DataSource& source)
{
    return impl_->sources.add(source);
}

std::uint32_t Server::add_source(std::shared_ptr<DataSource> source)
{
    return impl_->sources.add(std::move(source));
}

bool Server::raise_event(Event event)
{
    const auto queue = impl_->events->queue();
    return queue != nullptr && queue->raise(std::move(event));
}

std::shared_ptr<EventQueue> Server::event_queue() const
{
    return impl_->events->queue();
}

Result<Connection> Server::connect(std::string_view peer_address, TimePoint now)
{
    impl_->latest = now;
    std::unique_ptr<detail::PeerLink> link;
    const StatusCode thrown = busbar::detail::caught([&] {
        if (auto found = impl_->find_obstacle(peer_address); !found.empty()) {
            return impl_->refuse(peer_address, std::move(found));
        }
        link = std::make_unique<detail::PeerLink>(*impl_, peer_address, now);
    });
    if (link == nullptr) {
        return fail(thrown.is_bad() ? thrown : status::Bad_TcpServerTooBusy);
    }
    return Connection{std::move(link)};
}

void Server::Impl::refuse(std::string_view peer_address, std::string why)
{
    const Refusal refusal{status::Bad_TcpServerTooBusy, "place for a connection", std::move(why),
                          "Part 6, 7.1.2.5",
                          "Close connections that are not needed, or raise the limit"};
    log(LogLevel::Warning, "connection", printable(peer_address) + ": " + text(refusal));
}

Configured<void> Server::Impl::check_modules(const ServerConfig& wanted) const
{
    if (wanted.has_node_management && node_management == nullptr) {
        return misconfigured("has_node_management", "needs modules::node_management");
    }
    const bool has_issued = std::any_of(
        wanted.endpoints.begin(), wanted.endpoints.end(), [&](const EndpointConfig& endpoint) {
            return detail::accepts(endpoint, environment.users, UserTokenType::IssuedToken);
        });
    if (has_issued && session_needs.log_in_issued == nullptr) {
        return misconfigured("allows_issued", "needs modules::issued_tokens");
    }
    return {};
}

TimePoint Server::next_deadline() const
{
    return std::max(impl_->first_due(), impl_->retry);
}

TimePoint Server::Impl::first_due()
{
    if (events->has_model_changes() || subscriptions.sampler().is_behind()) {
        return TimePoint{}; // in the distant past
    }
    const detail::Session* first = sessions.next_due();
    return std::min({first != nullptr ? first->next_deadline() : no_deadline, shutdown_deadline,
                     certificate_check, old_channels_deadline, trust_check_deadline,
                     homeless_deadline, kept_memory.next_deadline(),
                     subscriptions.next_deadline()});
}

void Server::start(TimePoint now)
{
    impl_->latest = now;
    impl_->claim();
    impl_->watch_certificate(now);
}

void Server::handle_deadline(TimePoint now)
{
    impl_->latest = now;
    impl_->kept_memory.handle_deadline(now);
    bool is_done = true;
    const auto survive = [&](std::string_view what, FunctionRef<void()> work) {
        is_done = impl_->survive(what, work) && is_done;
    };
    survive("a check of certificates", [&] {
        if (impl_->certificate_check <= now) {
            impl_->watch_certificate(now);
        }
    });
    survive("model changes", [&] { impl_->events->announce_model_changes(); });
    survive("the end of a session", [&] { impl_->expire_sessions(now); });
    survive("a Subscription", [&] { impl_->subscriptions.handle_deadline(now); });
    survive("a scan", [&] {
        if (impl_->subscriptions.sampler().is_behind()) {
            impl_->subscriptions.sampler().catch_up(now);
        }
    });
    survive("the end of channels", [&] {
        if (impl_->homeless_deadline <= now) {
            impl_->end_homeless_sessions();
        }
        if (impl_->old_channels_deadline <= now) {
            impl_->close_old_channels();
        }
        if (impl_->trust_check_deadline <= now) {
            impl_->close_untrusted_channels();
        }
    });
    if (impl_->shutdown_deadline <= now) {
        impl_->finish_shutdown();
    }
    survive("the end of a call", [&] { impl_->sweep(); });
    impl_->retry = is_done ? TimePoint::min() : now + retry_pause;
}

/// A failure ends only the work it happened in; the rest of the call continues, and pending work is
/// done with the next call.
bool Server::Impl::survive(std::string_view what, FunctionRef<void()> work)
{
    return busbar::detail::guarded(rationed_log, what, [&] { work(); }).is_good();
}

void Server::Impl::expire_sessions(TimePoint now)
{
    detail::Session* session = sessions.next_due();
    while (session != nullptr && session->next_deadline() <= now) {
        if (session->deadline <= now) {
            ++counters.summary.session_timeout_count;
            session->end = detail::SessionEnd::Timeout;
            close_session(*session, status::Bad_SessionClosed, false);
        } else {
            detail::expire_user(session_needs, *session, now);
        }
        session = sessions.next_due();
    }
}

void Server::handle_completions(TimePoint now)
{
    impl_->latest = now;
    impl_->survive("the answer of a source", [&] { impl_->sources.handle_completions(); });
    impl_->survive("a password", [&] { impl_->password_checks.drain(now); });
    impl_->survive("an OpenSecureChannel", [&] { impl_->channel_work.drain(now); });
    impl_->survive("model changes", [&] { impl_->events->announce_model_changes(); });
    impl_->survive("an Event", [&] { impl_->events->handle_raised(); });
    impl_->survive("a scan", [&] { impl_->subscriptions.sampler().handle_scans(now); });
    impl_->survive("the end of a call", [&] { impl_->sweep(); });
}

std::optional<std::uint64_t> Server::next_changed()
{
    if (impl_->changed.empty()) {
        return std::nullopt;
    }
    detail::PeerLink& link = *impl_->changed.front();
    link.take_mark();
    return link.id();
}

void Server::announce_semantics_change(const NodeId& variable)
{
    impl_->subscriptions.announce_change({variable}, detail::ValueQueue::semantics_changed_bit);
    impl_->events->announce_semantics(variable);
}

void Server::announce_structure_change(const NodeId& variable)
{
    impl_->subscriptions.announce_change({variable}, detail::ValueQueue::structure_changed_bit);
}

void Server::announce_access_change(TimePoint now)
{
    impl_->subscriptions.access_changed(now);
}

SamplingState Server::sampling_state() const
{
    const detail::Sampler& sampler = impl_->subscriptions.sampler();
    return {sampler.smallest_revised_interval(), sampler.smallest_actual_interval()};
}

std::size_t Server::subscription_count() const
{
    return impl_->subscriptions.size();
}

std::size_t Server::monitored_item_count() const
{
    return impl_->subscriptions.item_count();
}

std::size_t Server::session_count() const
{
    return impl_->sessions.size();
}

std::size_t Server::connection_count() const
{
    return impl_->links.size();
}

} // namespace busbar::server
