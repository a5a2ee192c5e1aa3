#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <asio/any_io_executor.hpp>
#include <asio/ip/address.hpp>

namespace busbar::net::detail {

/// Returns the addresses of a host; none if it has none. Called on a separate thread: may block.
using Lookup = std::function<std::vector<asio::ip::address>(const std::string& host)>;

/// Returns the addresses that the system knows; for localhost the loopback addresses if it knows
/// none, as on a machine without a hosts file (RFC 6761, 6.3).
[[nodiscard]] std::vector<asio::ip::address> system_lookup(const std::string& host);
/// Returns the loopback addresses if `host` is localhost, else none.
[[nodiscard]] std::vector<asio::ip::address> loopback_addresses(std::string_view host);

/// Finds addresses without blocking. A name server that does not answer blocks getaddrinfo for any
/// time, and nothing can cancel that; so its thread is left running, at most one at a time. All
/// calls are made on the executor.
class NameLookup {
public:
    using Handler = std::function<void(std::vector<asio::ip::address>)>;

    NameLookup(asio::any_io_executor executor, Lookup lookup);
    NameLookup(const NameLookup&) = delete;
    NameLookup& operator=(const NameLookup&) = delete;
    /// Does not wait for the thread.
    ~NameLookup();

    /// Calls `handler` later, in place of one that still waits. An address needs no thread.
    void start(std::string host, Handler handler);
    /// The handler is not called any more.
    void cancel();

private:
    /// State that the thread and its owner share.
    struct Shared {
        std::mutex mutex;
        NameLookup* owner;
    };

    void run_thread();
    void finish(const std::string& host, std::vector<asio::ip::address> addresses);

    asio::any_io_executor executor_;
    Lookup lookup_;
    std::shared_ptr<Shared> shared_;
    std::string host_;
    Handler handler_;
    bool is_running_{false};
};

} // namespace busbar::net::detail
