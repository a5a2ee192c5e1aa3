#include <busbar/harness/network.hpp>

#include <algorithm>
#include <stdexcept>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text.hpp>

#include "fault_filter.hpp"
#include "timeline.hpp"

namespace busbar::harness {

namespace {

Result<std::string> key_of(std::string_view url)
{
    auto parsed = channel::EndpointUrl::parse(url);
    if (!parsed) {
        return fail(parsed.error());
    }
    std::string key = parsed->host + ":" + std::to_string(parsed->port);
    std::transform(key.begin(), key.end(), key.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return key;
}

/// Returns whether it acts on a whole connection, at no particular time.
bool is_immediate(const Fault& fault)
{
    using enum Fault::Kind;
    const bool is_of_link =
        fault.kind == Cut || fault.kind == Hold || fault.kind == HalfOpen || fault.kind == Split;
    return is_of_link && !fault.message && !fault.byte_offset && !fault.time;
}

} // namespace

Network::Network(Scheduler& scheduler, JumpingClock& clock, std::uint64_t seed, LogSink* log)
    : scheduler_{&scheduler}, log_{log}, seed_{seed}, timeline_{std::make_shared<detail::Timeline>(
                                                          scheduler)},
      tap_{std::make_shared<detail::ChunkTap>()}, faults_{std::make_shared<detail::ActingFaults>(
                                                      clock, timeline_, tap_)}
{
    no_weather_.min_latency = Duration{0};
    no_weather_.max_latency = Duration{0};
}

Network::~Network() = default;

channel::ChunkHook& Network::chunk_hook()
{
    return *tap_;
}

Result<void> Network::listen(std::string_view url, Acceptor& acceptor)
{
    const auto key = key_of(url);
    if (!key) {
        return fail(key.error());
    }
    const auto [known, is_new] = acceptors_.emplace(*key, &acceptor);
    if (!is_new && known->second != &acceptor) {
        log("another acceptor listens at " + *key + " already");
        return fail(status::Bad_InvalidState);
    }
    return {};
}

void Network::unlisten(const Acceptor& acceptor)
{
    for (auto at = acceptors_.begin(); at != acceptors_.end();) {
        at = at->second == &acceptor ? acceptors_.erase(at) : std::next(at);
    }
}

Result<std::shared_ptr<Link>> Network::connect(std::string_view url, LinkEnd& client,
                                               std::string_view client_address)
{
    const auto key = key_of(url);
    const auto found = key ? acceptors_.find(*key) : acceptors_.end();
    const bool is_exempt = key && std::find(exempt_.begin(), exempt_.end(), *key) != exempt_.end();
    const auto refuse_absent = [&] {
        log("there is no listener at " + printable(url) + listeners());
        return fail(status::Bad_ConnectionRejected);
    };
    if (is_exempt) {
        if (found == acceptors_.end()) {
            return refuse_absent(); // outside of the network, so that faults do not count it
        }
        return connect_plainly(*found->second, client, client_address);
    }
    ++connection_count_;
    for (auto& entry : faults_->entries()) {
        if (entry.fault.kind == Fault::Kind::Refuse && entry.is_for(connection_count_)) {
            faults_->count(entry, connection_count_);
            return fail(status::Bad_ConnectionRejected);
        }
    }
    if (refuses_) {
        return fail(status::Bad_ConnectionRejected);
    }
    if (found == acceptors_.end()) {
        return refuse_absent();
    }
    if (const auto name = client_names_.find(client_address); name != client_names_.end()) {
        timeline_->name_client(connection_count_, name->second);
    }
    constexpr std::uint64_t first_stream = 1'000;
    const auto own = weathers_.find(client_address);
    const auto link =
        std::make_shared<Link>(*scheduler_, own == weathers_.end() ? weather_ : own->second,
                               Chance{seed_, first_stream + connection_count_});
    link->set_filter(std::make_unique<detail::FaultFilter>(faults_, connection_count_));
    link->set_observer(observer_);
    link->attach(Side::Client, client);
    if (!found->second->accept(link, client_address)) {
        link->leave(Side::Client);
        return fail(status::Bad_ConnectionRejected);
    }
    begin(link);
    return link;
}

Result<std::shared_ptr<Link>> Network::connect_plainly(Acceptor& acceptor, LinkEnd& client,
                                                       std::string_view client_address)
{
    const auto link = std::make_shared<Link>(*scheduler_, no_weather_, Chance{seed_, 0});
    link->attach(Side::Client, client);
    if (!acceptor.accept(link, client_address)) {
        link->leave(Side::Client);
        return fail(status::Bad_ConnectionRejected);
    }
    return link;
}

Result<void> Network::exempt(std::string_view url)
{
    auto key = key_of(url);
    if (!key) {
        return fail(key.error());
    }
    exempt_.push_back(*std::move(key));
    return {};
}

Weather& Network::weather_of(std::string_view client_address)
{
    const auto known = weathers_.find(client_address);
    return known != weathers_.end()
               ? known->second
               : weathers_.emplace(std::string{client_address}, weather_).first->second;
}

void Network::name_client(std::string_view address, std::string_view name)
{
    client_names_.insert_or_assign(std::string{address}, std::string{name});
}

std::string Network::listeners() const
{
    std::string text;
    for (const auto& [key, acceptor] : acceptors_) {
        text += (text.empty() ? "; there is " : ", ") + ("opc.tcp://" + key);
    }
    return text;
}

void Network::log(const std::string& text)
{
    if (log_ != nullptr) {
        log_->write(LogLevel::Warning, "network", text);
    }
}

std::string Network::trace(std::size_t lines) const
{
    return timeline_->last(lines);
}

void Network::begin(const std::shared_ptr<Link>& link)
{
    links_.erase(std::remove_if(links_.begin(), links_.end(),
                                [](const auto& known) { return known.second.expired(); }),
                 links_.end());
    links_.emplace_back(connection_count_, link);
    for (auto& entry : faults_->entries()) {
        if (is_immediate(entry.fault) && entry.is_for(connection_count_)) {
            faults_->count(entry, connection_count_);
            faults_->act(entry.fault, *link, Side::Client);
        }
    }
}

void Network::act(std::size_t index)
{
    auto& entry = faults_->entries()[index];
    const Fault& fault = entry.fault;
    if (fault.kind == Fault::Kind::JumpClock) {
        faults_->count(entry, 0);
        faults_->jump(fault.duration);
        return;
    }
    bool has_acted = false;
    for (const auto& [number, known] : links_) {
        const auto link =
            fault.connection == 0 || fault.connection == number ? known.lock() : nullptr;
        if (link != nullptr && !link->is_cut()) {
            faults_->act(fault, *link, Side::Client);
            has_acted = true;
        }
    }
    if (has_acted) {
        faults_->count(entry, 0);
    }
}

void Network::play(const FaultScript& script)
{
    for (const Fault& fault : script) {
        if (const std::string flaw = detail::flaw_of(fault); !flaw.empty()) {
            throw std::invalid_argument{"the fault \"" + describe(fault) +
                                        "\" can never act: " + flaw};
        }
    }
    for (const Fault& fault : script) {
        const std::size_t index = faults_->entries().size();
        faults_->add(fault);
        const bool is_plain_jump = fault.kind == Fault::Kind::JumpClock && !fault.message &&
                                   !fault.byte_offset && !fault.time;
        if (fault.time) {
            scheduler_->after(*fault.time, [this, index] { act(index); });
        } else if (is_plain_jump || is_immediate(fault)) {
            act(index);
        }
    }
}

std::string Network::pending_faults() const
{
    return faults_->pending();
}

void Network::cut()
{
    timeline_->happened(0, "cut");
    for (const auto& [number, known] : links_) {
        if (const auto link = known.lock()) {
            link->cut();
        }
    }
}

} // namespace busbar::harness
