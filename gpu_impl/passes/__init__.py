"""The stages of Weng 2010, Figure 1.3, one file each, in the order in which a frame runs them.

geometry        what the eye sees first (a G-buffer)
shadow_map      what each light sees first
shadow_buffer   the same in a buffer, where a technique asks for it
surface         "Render Scene": direct light on what the eye sees
scattering      "Render Scattering Effect": airlight on every N-th pixel
combination     "Bilateral filter": the airlight brought to full resolution and added to the attenuated surface
tone_mapping    for a display; not in the figure, and never before a measurement
"""
