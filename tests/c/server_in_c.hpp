#pragma once

#include <catch2/catch.hpp>

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include <busbar/busbar.h>

namespace busbar::test {

/// A server of the C interface without security, at a free port.
class ServerInC {
public:
    ServerInC()
    {
        busbar_server_config config;
        busbar_server_config_init(&config);
        config.application.uri = "urn:test:server-in-c";
        config.address = "127.0.0.1";
        config.takes_free_port = true;
        config.shutdown_delay_ms = 0;
        config.anonymous_may_write = true;
        const busbar_endpoint open{"None", BUSBAR_MODE_NONE, true, false};
        config.endpoints = &open;
        config.endpoint_count = 1;
        const busbar_status created = busbar_server_create(&config, &server);
        INFO(busbar_server_last_error(server));
        REQUIRE(created == BUSBAR_GOOD);
        REQUIRE(busbar_server_add_namespace(server, "urn:test:machine", &index) == BUSBAR_GOOD);
    }
    ServerInC(const ServerInC&) = delete;
    ServerInC& operator=(const ServerInC&) = delete;
    ~ServerInC()
    {
        stop();
        busbar_server_destroy(server);
    }
    /// Serves on a thread of its own from now on.
    void run()
    {
        REQUIRE(busbar_server_start(server) == BUSBAR_GOOD);
        thread_ = std::thread{[this] {
            while (busbar_server_poll(server, 5) == BUSBAR_GOOD && !ends_) {
            }
        }};
    }
    void stop()
    {
        ends_ = true;
        if (thread_.joinable()) {
            thread_.join();
        }
    }
    [[nodiscard]] busbar_node node(const char* name) const
    {
        busbar_node node{};
        node.name = name;
        node.namespace_index = index;
        return node;
    }
    [[nodiscard]] busbar_variable variable(const char* name, const busbar_value& value) const
    {
        busbar_variable variable;
        busbar_variable_init(&variable);
        variable.node = node(name);
        variable.value = value;
        variable.is_writable = true;
        return variable;
    }
    [[nodiscard]] std::string url() const
    {
        return "opc.tcp://127.0.0.1:" + std::to_string(busbar_server_port(server));
    }

    busbar_server* server{nullptr};
    std::uint16_t index{0};

private:
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

/// A client of the C interface for a server without security.
class ClientInC {
public:
    explicit ClientInC(const std::string& url)
    {
        busbar_client_config config;
        busbar_client_config_init(&config);
        config.application.uri = "urn:test:client-in-c";
        config.url = url.c_str();
        config.least_mode = BUSBAR_MODE_NONE;
        config.request_timeout_ms = 5'000;
        const busbar_status created = busbar_client_create(&config, &client);
        INFO(busbar_client_last_error(client));
        REQUIRE(created == BUSBAR_GOOD);
    }
    ClientInC(const ClientInC&) = delete;
    ClientInC& operator=(const ClientInC&) = delete;
    ~ClientInC() { busbar_client_destroy(client); }

    void connect()
    {
        const busbar_status connected = busbar_client_connect(client, 10'000);
        INFO(busbar_client_last_error(client));
        REQUIRE(connected == BUSBAR_GOOD);
    }
    [[nodiscard]] busbar_data_value read(const char* node)
    {
        busbar_data_value value{};
        REQUIRE(busbar_client_read(client, &node, 1, &value) == BUSBAR_GOOD);
        return value;
    }
    [[nodiscard]] busbar_status write(const char* node, const busbar_value& value)
    {
        busbar_status result = 0;
        REQUIRE(busbar_client_write(client, &node, &value, 1, &result) == BUSBAR_GOOD);
        return result;
    }

    busbar_client* client{nullptr};
};

/// Moves what a folder has rejected to what it trusts.
inline void trust_all(const std::filesystem::path& folder)
{
    for (const auto& entry : std::filesystem::directory_iterator{folder / "rejected" / "certs"}) {
        std::filesystem::rename(entry.path(),
                                folder / "trusted" / "certs" / entry.path().filename());
    }
}

inline std::string text_of(const busbar_text& text)
{
    return text.data != nullptr ? std::string{text.data, text.size} : std::string{"null"};
}

} // namespace busbar::test
