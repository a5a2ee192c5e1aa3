#include "name_lookup.hpp"

#include <system_error>
#include <thread>
#include <utility>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/post.hpp>

#include <busbar/channel/endpoint_url.hpp>

namespace busbar::net::detail {

std::vector<asio::ip::address> system_lookup(const std::string& host)
{
    asio::io_context context;
    asio::ip::tcp::resolver resolver{context};
    std::error_code error;
    std::vector<asio::ip::address> addresses;
    for (const auto& entry : resolver.resolve(host, "", error)) {
        addresses.push_back(entry.endpoint().address());
    }
    return addresses.empty() ? loopback_addresses(host) : addresses;
}

std::vector<asio::ip::address> loopback_addresses(std::string_view host)
{
    if (host.ends_with('.')) {
        host.remove_suffix(1);
    }
    if (!channel::is_same_host(host, "localhost")) {
        return {};
    }
    return {asio::ip::address_v4::loopback(), asio::ip::address_v6::loopback()};
}

NameLookup::NameLookup(asio::any_io_executor executor, Lookup lookup)
    : executor_{std::move(executor)}, lookup_{std::move(lookup)}, shared_{
                                                                      std::make_shared<Shared>()}
{
    shared_->owner = this;
}

NameLookup::~NameLookup()
{
    const std::lock_guard lock{shared_->mutex};
    shared_->owner = nullptr;
}

void NameLookup::start(std::string host, Handler handler)
{
    host_ = std::move(host);
    handler_ = std::move(handler);
    std::error_code error;
    const auto address = asio::ip::make_address(host_, error);
    if (!error) {
        asio::post(executor_, [shared = shared_, host = host_, address] {
            if (shared->owner != nullptr) {
                shared->owner->finish(host, {address});
            }
        });
    } else if (!is_running_) {
        run_thread();
    }
}

void NameLookup::cancel()
{
    handler_ = nullptr;
}

void NameLookup::run_thread()
{
    const auto look_up = [shared = shared_, lookup = lookup_, host = host_] {
        auto addresses = lookup(host);
        const std::lock_guard lock{shared->mutex};
        if (shared->owner == nullptr) {
            return;
        }
        // The executor exists as long as the owner.
        asio::post(shared->owner->executor_, [shared, host, found = std::move(addresses)] {
            if (shared->owner != nullptr) { // only its own thread, this one, changes it
                shared->owner->is_running_ = false;
                shared->owner->finish(host, found);
            }
        });
    };
    try {
        std::thread{look_up}.detach();
        is_running_ = true;
    } catch (const std::system_error&) { // no more threads: treated as no answer
        asio::post(executor_, [shared = shared_, host = host_] {
            if (shared->owner != nullptr) {
                shared->owner->finish(host, {});
            }
        });
    }
}

void NameLookup::finish(const std::string& host, std::vector<asio::ip::address> addresses)
{
    if (!handler_) {
        return;
    }
    if (host == host_) {
        const Handler handler = std::exchange(handler_, nullptr);
        handler(std::move(addresses));
    } else if (!is_running_) {
        run_thread(); // that was the answer to an older question
    }
}

} // namespace busbar::net::detail
