"""Pictures of workspaces: text for a terminal, stills by matplotlib, a page whose cloud turns with the mouse."""
