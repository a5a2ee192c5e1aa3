#include <catch2/catch.hpp>

#include <csignal>
#include <functional>
#include <memory>
#include <utility>

#include "net/machine.hpp"
#include "support/temporary_folder.hpp"
#include "tool/connection/connection.hpp"

namespace connection_test {

using namespace busbar;
using namespace busbar::tool;

// What becomes of an answer that a command no longer waits for.

TEST_CASE("an answer that comes after Ctrl+C goes nowhere")
{
    test::Machine machine;
    const test::TemporaryFolder folder;
    Context context;
    context.options.url = machine.url();
    context.options.is_insecure = true;
    context.options.pki = folder.path.string();
    Connection connection{context};
    using Answer = std::shared_ptr<int>;
    std::function<void(Answer)> late;
    CHECK_THROWS_AS(connection.wait_for<Answer>([&](std::function<void(Answer)> done) {
        late = std::move(done);
        std::raise(SIGINT);
    }),
                    Interrupted);
    const Answer answer = std::make_shared<int>(1);
    late(answer); // as the end of the connection does, for requests that wait
    late = nullptr;
    CHECK(answer.use_count() == 1);
}

} // namespace connection_test
