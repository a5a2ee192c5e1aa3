#include <busbar/harness/network.hpp>

#include <algorithm>

#include <busbar/channel/endpoint_url.hpp>

#include "fault_filter.hpp"

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

Network::Network(Scheduler& scheduler, JumpingClock& clock, std::uint64_t seed)
    : scheduler_{&scheduler}, seed_{seed}, faults_{std::make_shared<detail::ActingFaults>(clock)}
{
}

Network::~Network() = default;

Result<void> Network::listen(std::string_view url, Acceptor& acceptor)
{
    const auto key = key_of(url);
    if (!key) {
        return fail(key.error());
    }
    acceptors_[*key] = &acceptor;
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
    ++connection_count_;
    for (auto& entry : faults_->entries()) {
        if (entry.fault.kind == Fault::Kind::Refuse && entry.is_for(connection_count_)) {
            ++entry.acted;
            return fail(status::Bad_ConnectionRejected);
        }
    }
    if (refuses_ || found == acceptors_.end()) {
        return fail(status::Bad_ConnectionRejected);
    }
    constexpr std::uint64_t first_stream = 1'000;
    const auto link = std::make_shared<Link>(*scheduler_, weather_,
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

void Network::begin(const std::shared_ptr<Link>& link)
{
    links_.erase(std::remove_if(links_.begin(), links_.end(),
                                [](const auto& known) { return known.expired(); }),
                 links_.end());
    links_.push_back(link);
    for (auto& entry : faults_->entries()) {
        if (is_immediate(entry.fault) && entry.is_for(connection_count_)) {
            ++entry.acted;
            faults_->act(entry.fault, *link, Side::Client);
        }
    }
}

void Network::act(const Fault& fault, std::size_t& acted)
{
    if (fault.kind == Fault::Kind::JumpClock) {
        faults_->jump(fault.duration);
        ++acted;
        return;
    }
    bool has_acted = false;
    for (const auto& known : links_) {
        if (const auto link = known.lock(); link != nullptr && !link->is_cut()) {
            faults_->act(fault, *link, Side::Client);
            has_acted = true;
        }
    }
    acted += has_acted ? 1U : 0U;
}

void Network::play(const FaultScript& script)
{
    for (const Fault& fault : script) {
        auto& entry = faults_->add(fault);
        const bool is_plain_jump = fault.kind == Fault::Kind::JumpClock && !fault.message &&
                                   !fault.byte_offset && !fault.time;
        if (fault.time) {
            scheduler_->after(*fault.time, [this, &entry] { act(entry.fault, entry.acted); });
        } else if (is_plain_jump || is_immediate(fault)) {
            act(entry.fault, entry.acted);
        }
    }
}

std::string Network::pending_faults() const
{
    return faults_->pending();
}

void Network::cut()
{
    for (const auto& known : links_) {
        if (const auto link = known.lock()) {
            link->cut();
        }
    }
}

} // namespace busbar::harness
