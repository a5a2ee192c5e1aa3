#include <stdio.h>
#include <string.h>

#include <busbar/busbar.h>

int main(void)
{
    const busbar_endpoint open = {"None", BUSBAR_MODE_NONE, true, false};
    busbar_server_config config;
    busbar_server_config_init(&config);
    config.application.uri = "urn:test:in-c";
    config.address = "127.0.0.1";
    config.takes_free_port = true;
    config.endpoints = &open;
    config.endpoint_count = 1;
    busbar_server* server = NULL;
    busbar_status status = busbar_server_create(&config, &server);
    if (status == BUSBAR_GOOD) {
        status = busbar_server_start(server);
    }
    if (status == BUSBAR_GOOD) {
        status = busbar_server_poll(server, 0);
    }
    printf("%s %s %s\n", busbar_version(), busbar_status_name(status),
           busbar_server_last_error(server));
    busbar_server_destroy(server);
    return status != BUSBAR_GOOD;
}
