#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/controller/mapped_source.hpp>
#include <busbar/controller/simulated_labels.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/net/system.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/server/process_image.hpp>

#include "mapped/mapped_model.hpp"

namespace busbar::bench {

/// A program with the labels of so many Variables of a MappedModel, all INT.
[[nodiscard]] Configured<controller::Program> program_of_labels(std::size_t variables);

/// A server of model mode with its PLC: two threads of this process. Its Variables are there twice,
/// in namespace 2 mapped to labels and in namespace 3 in a process image; half of both grow by one
/// in each scan of 20 ms.
class MappedPlant {
public:
    static constexpr Duration cycle = std::chrono::milliseconds{20};

    [[nodiscard]] static Configured<std::unique_ptr<MappedPlant>>
    start(const MappedModel& model, controller::SamplingMode mode);
    MappedPlant(const MappedPlant&) = delete;
    MappedPlant& operator=(const MappedPlant&) = delete;
    /// Stops both threads.
    ~MappedPlant();

    /// Basic256Sha256 with SignAndEncrypt, for anonymous users, who may write.
    [[nodiscard]] const std::string& url() const { return url_; }

private:
    explicit MappedPlant(controller::SamplingMode mode) : mode_{mode} {}
    [[nodiscard]] Configured<void> make_labels(std::size_t variables);
    [[nodiscard]] Configured<void> make_server();
    [[nodiscard]] Configured<void> map(const MappedModel& model);
    [[nodiscard]] Configured<void> make_image(std::size_t variables);
    void scan_until_stopped();

    controller::SamplingMode mode_;
    NullLog log_;
    net::SystemWallClock wall_clock_;
    crypto::SystemRandom random_;
    crypto::InsecureAcceptAnyCertificate validator_;
    server::PasswordUsers users_;
    binary::DynamicTypes types_;
    net::ServerLoop loop_{log_};
    std::shared_ptr<controller::SimulatedLabels> labels_;
    std::shared_ptr<server::ProcessImage> image_;
    std::optional<controller::MappedSource> source_;
    std::optional<server::ImageSource> image_source_;
    std::optional<server::Server> server_;
    std::string url_;
    /// What grows with each scan, of labels_ and of image_.
    std::vector<std::int16_t*> moving_;
    std::atomic<bool> is_stopping_{false};
    std::thread plc_;
    std::thread serving_;
};

} // namespace busbar::bench
